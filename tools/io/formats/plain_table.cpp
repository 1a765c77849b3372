// SPDX-License-Identifier: BSD-3-Clause
// Tables of any program: names of columns somewhere in the file, perhaps a line of units and one with the number of
// rows, rows below.  A file may hold several of them, as the steps of a rheometer or the traces of an analyser.
#include <algorithm>
#include <array>
#include <set>

#include "io/column_name.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/instrument_name.hpp"
#include "io/number.hpp"

namespace io {
namespace {

using Fields = std::vector<std::string_view>;

constexpr std::array separators{'\t', ';', ',', ' '};

bool is_number(std::string_view field) {
  return parse_number(field) || has_decimal_commas({field});
}

struct Names {
  std::string_view line;
  std::size_t number = 0;
  char separator = ',';
  std::size_t frequency = 0;  // its column
  std::size_t width = 0;
  bool is_first = false;   // of the lines with content
  bool is_quoted = false;  // all of them together
};

// ZPlot and ZView write all names within one pair of quotes where the file has no "End Comments"; programs of audio and
// MATLAB begin the line of names as a comment of theirs.
std::string_view without_quotes_around(std::string_view line) {
  std::string_view text = trimmed(line);
  if (text.starts_with('*') || text.starts_with('%') || text.starts_with('!')) return trimmed(text.substr(1));
  const bool is_quoted = text.size() > 2 && text.front() == '"' && text.find('"', 1) == text.size() - 1;
  return is_quoted ? text.substr(1, text.size() - 2) : line;
}

// Column names as they stand above the rows of a spectrum: no number, and a frequency among them.
std::optional<Names> names_in(std::string_view line, std::size_t number) {
  Fields fields;
  const std::string_view inner = without_quotes_around(line);
  for (const char separator : separators) {
    if (inner.find(separator) == std::string_view::npos) continue;
    split_by(trimmed(inner), separator, fields);
    if (fields.size() < 2 || holds_a_number(fields)) continue;
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (column_meaning(fields[i]).quantity == Quantity::frequency)
        return Names{inner,
                     number,
                     separator,
                     i,
                     fields.size(),
                     false,
                     inner.size() < line.size() && trimmed(line).front() == '"'};
  }
  return std::nullopt;
}

// Cuts a line; false where it has not as many fields as there are names.  Tabs at its ends stand for empty fields.
bool cut(std::string_view line, char separator, std::size_t width, Fields& fields) {
  split_by(trimmed(line), separator, fields);
  if (separator == '\t' && fields.size() < width && line.starts_with('\t')) split_by(line, separator, fields);
  if (separator == '\t' && fields.size() < width)
    fields.resize(std::min(width, fields.size() + line.size() - 1 - line.find_last_not_of('\t')));
  return fields.size() == width;
}

// How rows below these names are cut, of which this line is the first; nothing where it is none.  A step of another
// kind leaves the frequency empty.
std::optional<char> separator_of_row(std::string_view line, const Names& names, Fields& fields) {
  const auto fits = [&](char separator) {
    return cut(line, separator, names.width, fields) &&
           (is_number(fields[names.frequency]) ||
            (fields[names.frequency].empty() && std::any_of(fields.begin(), fields.end(), is_number)));
  };
  if (fits(names.separator)) return names.separator;
  const auto* const found = std::find_if(separators.begin(), separators.end(), fits);
  return found == separators.end() ? std::nullopt : std::optional(*found);
}

bool are_units(std::string_view line, const Names& names, Fields& fields) {
  const auto fits = [&](char separator) {
    return cut(line, separator, names.width, fields) && is_frequency_unit(without_brackets(fields[names.frequency]));
  };
  return fits(names.separator) || std::any_of(separators.begin(), separators.end(), fits);
}

class TableSearch {
 public:
  TableSearch(const Source& source, bool is_told, std::vector<std::size_t> told)
      : text_(source.text), lines_(*text_), is_told_(is_told), told_(std::move(told)) {}

  std::optional<Recognised> find() {
    for (std::string_view line; lines_.next(line);) {
      const auto content = trimmed(line);
      if (content.empty()) {
        is_after_gap_ = true;
        continue;
      }
      if (is_comment(content)) continue;
      take(line, content);
      line_above_ = line;
      number_above_ = lines_.number();
      is_after_gap_ = is_first_ = false;
    }
    if (open_) close(text_->size());
    if (found_.sweeps.empty()) return std::nullopt;
    if (text_->find("Instrument Model:  CHI") < std::get<TextLayout>(found_.sweeps.front().content).begin)
      found_.format = "CH Instruments";
    // TextTable reads a plain one, with the entries in its comments.
    if (is_plain_ && found_.sweeps.size() == 1 && left_out_ == 0 && found_.notes.empty()) return std::nullopt;
    name_sweeps();
    if (left_out_ > 0)
      found_.notes.push_back("what stands from line " + std::to_string(left_out_) +
                             " on, below the table, is no frequency response and left out");
    return std::move(found_);
  }

 private:
  struct Open {
    TextLayout layout;
    std::size_t width = 0, frequency = 0, rows = 1;
    std::string title;
  };

  void take(std::string_view line, std::string_view content) {
    if (open_) {
      if (goes_on(line, content)) {
        ++open_->rows;
        end_ = lines_.after();
        return;
      }
      if (open_) close(end_);
      left_out_ = lines_.number();
    }
    if (opens(line)) return;
    if (content.starts_with('[')) {
      is_after_gap_ = true;
      title_ = {};
      is_title_next_ = true;
    } else if ((is_after_gap_ || is_title_next_) && !names_ && !names_in(line, 0)) {
      title_ = content;
      is_title_next_ = false;
    }
  }

  // A row that is wrong goes on too, and is refused with its place when rows are read.  A table ends at an empty line
  // or a title in brackets where what follows is of another kind.
  bool goes_on(std::string_view line, std::string_view content) {
    if (content.starts_with('[')) return false;
    const bool has_width = cut(line, open_->layout.separator, open_->width, fields_);
    // One line of numbers by itself is no table: settings stand so above some.
    if (is_told_ && open_->rows == 1 && !has_width) {
      open_.reset();
      return false;
    }
    if (!is_after_gap_) return has_width || !is_end(line);
    if (has_width && !names_in(line, 0)) return true;
    return is_number(fields_.front());
  }

  /// "END": no number, and none in what follows before a gap or the end.
  bool is_end(std::string_view line) {
    split_by(trimmed(line), open_->layout.separator, fields_);
    if (holds_a_number(fields_) || has_decimal_commas(fields_)) return false;
    LineReader rest(std::string_view(*text_).substr(std::min(lines_.after(), text_->size())));
    std::string_view next;
    if (!rest.next(next) || trimmed(next).empty()) return true;
    split_by(trimmed(next), open_->layout.separator, fields_);
    return !holds_a_number(fields_) && !has_decimal_commas(fields_);
  }

  bool opens(std::string_view line) {
    if (is_told_) return opens_told(line);
    if (names_) {
      if (const auto separator = separator_of_row(line, *names_, fields_)) {
        is_plain_ =
            names_->is_first && number_above_ == names_->number && separator_of(trimmed(names_->line)) == *separator;
        if (names_->is_quoted) {
          found_.format = "ZView";
          found_.unit = "ohm";
        }
        open(named_columns(names_->line, names_->separator, names_->number, units_), *separator, names_->frequency);
        return true;
      }
      if (units_.empty() && are_units(line, *names_, fields_)) {
        units_ = line;
        return true;
      }
      if (parse_count(trimmed(line))) return true;  // how many rows follow
      units_ = {};
      // A full line of as many fields is another kind of names; any other one may stand between names and rows.
      if (cut(line, names_->separator, names_->width, fields_) &&
          std::none_of(fields_.begin(), fields_.end(), [](std::string_view field) { return field.empty(); }))
        names_.reset();
    }
    if (auto names = names_in(line, lines_.number())) {
      names_ = names;
      names_->is_first = is_first_;
    }
    return false;
  }

  bool opens_told(std::string_view line) {
    const std::size_t least = told_.empty() ? 2 : *std::max_element(told_.begin(), told_.end()) + 1;
    for (const char separator : separators) {
      split_by(trimmed(line), separator, fields_);
      if (fields_.size() < least) continue;
      if (told_.empty() ? std::count_if(fields_.begin(), fields_.end(), is_number) < 2
                        : !std::all_of(told_.begin(), told_.end(), [&](auto i) { return is_number(fields_[i]); }))
        continue;
      std::vector<TextLayout::Column> columns;
      if (!line_above_.empty()) columns = named_columns(without_quotes_around(line_above_), separator, number_above_);
      if (columns.size() != fields_.size()) {
        columns.clear();
        for (std::size_t i = 1; i <= fields_.size(); ++i)
          columns.push_back({"column " + std::to_string(i), lines_.number(), column_in(line, fields_[i - 1])});
      }
      open(std::move(columns), separator, told_.empty() ? 0 : told_.front());
      return true;
    }
    return false;
  }

  void open(std::vector<TextLayout::Column> columns, char separator, std::size_t frequency) {
    open_ = Open{{text_, std::move(columns)}, fields_.size(), frequency, 1, {}};
    open_->layout.separator = separator;
    open_->layout.begin = lines_.begin();
    open_->layout.first_line = lines_.number();
    split_by(title_, '\t', fields_);
    if (!title_.empty()) open_->title = std::string(fields_.back());
    end_ = lines_.after();
    left_out_ = 0;
    names_.reset();
    units_ = title_ = {};
  }

  void close(std::size_t end) {
    open_->layout.end = std::min(end, text_->size());
    settle_decimal_commas(open_->layout, found_);
    frequencies_.push_back(open_->frequency);
    found_.sweeps.push_back({std::move(open_->title), std::move(open_->layout)});
    open_.reset();
  }

  // Several tables are told apart by their titles.  A sweep of the amplitude or of time is no frequency response.
  void name_sweeps() {
    auto& sweeps = found_.sweeps;
    if (sweeps.size() == 1) {
      sweeps.front().name.clear();
      return;
    }
    std::set<std::string> taken;
    std::string left_out;
    for (std::size_t i = 0; i < sweeps.size(); ++i) {
      std::string& name = sweeps[i].name;
      if (name.empty() || !taken.insert(name).second) {
        name += (name.empty() ? "table " : "-") + std::to_string(i + 1);
        taken.insert(name);
      }
      sweeps[i].is_derived = is_at_one_frequency(std::get<TextLayout>(sweeps[i].content), frequencies_[i]);
      if (sweeps[i].is_derived) left_out += (left_out.empty() ? "" : ", ") + name;
    }
    if (std::all_of(sweeps.begin(), sweeps.end(), [](const Sweep& sweep) { return sweep.is_derived; })) {
      for (auto& sweep : sweeps) sweep.is_derived = false;
      return;
    }
    if (!left_out.empty()) found_.notes.push_back("left out, as all at one frequency: " + left_out);
    std::stable_partition(sweeps.begin(), sweeps.end(), [](const Sweep& sweep) { return !sweep.is_derived; });
  }

  bool is_at_one_frequency(const TextLayout& layout, std::size_t frequency) {
    LineReader rows(std::string_view(*layout.text).substr(0, layout.end));
    rows.skip_to(layout.begin);
    std::set<double> values;
    for (std::string_view row; values.size() < 2 && rows.next(row);) {
      if (!cut(row, layout.separator, layout.columns.size(), fields_)) continue;
      if (const auto value = parse_number(fields_[frequency])) values.insert(*value);
    }
    return values.size() < 2;
  }

  std::shared_ptr<const std::string> text_;
  LineReader lines_;
  bool is_told_;
  std::vector<std::size_t> told_;
  Recognised found_{"table", {}};
  std::vector<std::size_t> frequencies_;  // their columns in the tables found
  std::optional<Open> open_;
  std::size_t end_ = 0;  // of its rows
  std::optional<Names> names_;
  std::string_view units_, title_, line_above_;
  std::size_t number_above_ = 0, left_out_ = 0;
  bool is_first_ = true, is_after_gap_ = true, is_title_next_ = false;
  bool is_plain_ = false;  // as TextTable reads it: names first, no units below
  Fields fields_;
};

}  // namespace

std::optional<Recognised> read_plain_table(const Source& source) {
  return TableSearch(source, false, {}).find();
}

std::optional<Recognised> read_told_table(const Source& source, const std::vector<std::size_t>& columns) {
  return TableSearch(source, true, columns).find();
}

}  // namespace io
