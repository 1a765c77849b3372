// SPDX-License-Identifier: BSD-3-Clause
// Tables of any program: names of columns somewhere in the file, perhaps a line of units, rows below.
#include <algorithm>
#include <array>

#include "io/column_name.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/instrument_name.hpp"
#include "io/number.hpp"

namespace io {
namespace {

using Fields = std::vector<std::string_view>;

constexpr std::array separators{'\t', ';', ',', ' '};

bool holds_number_of_any_kind(const Fields& fields) {
  return holds_a_number(fields) || has_decimal_commas(fields);
}

struct Names {
  std::string_view line;
  std::size_t number = 0;
  char separator = ',';
  std::size_t frequency = 0;  // its column
  bool is_first = false;      // of the lines with content
};

// Column names as they stand above the rows of a spectrum: no number, and a frequency among them.
std::optional<Names> names_in(std::string_view line, std::size_t number) {
  Fields fields;
  for (const char separator : separators) {
    if (line.find(separator) == std::string_view::npos) continue;
    split_by(trimmed(line), separator, fields);
    if (fields.size() < 2 || holds_a_number(fields)) continue;
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (column_meaning(fields[i]).quantity == Quantity::frequency) return Names{line, number, separator, i, false};
  }
  return std::nullopt;
}

// How the line is cut into as many fields as there are names.
std::optional<char> separator_giving(std::string_view line, std::size_t width, char expected) {
  Fields fields;
  split_by(trimmed(line), expected, fields);
  if (fields.size() == width) return expected;
  for (const char separator : separators) {
    split_by(trimmed(line), separator, fields);
    if (fields.size() == width) return separator;
  }
  return std::nullopt;
}

std::string format_of(std::string_view preamble) {
  return preamble.find("Instrument Model:  CHI") != std::string_view::npos ? "CH Instruments" : "table";
}

}  // namespace

std::optional<Recognised> read_plain_table(const Source& source) {
  constexpr std::size_t most_lines_above = 1000;
  LineReader lines(*source.text);
  std::optional<Names> names;
  std::string_view units;
  Fields fields;
  bool is_first = true;
  for (std::string_view line; lines.next(line);) {
    const auto content = trimmed(line);
    if (content.empty()) continue;
    if (is_comment(content)) {
      if (!names && lines.number() > most_lines_above) return std::nullopt;
      continue;
    }
    if (names) {
      split_by(trimmed(names->line), names->separator, fields);
      const std::size_t width = fields.size();
      const auto separator = separator_giving(line, width, names->separator);
      if (separator) {
        split_by(content, *separator, fields);
        if (holds_number_of_any_kind(fields)) {
          Recognised found{format_of(std::string_view(*source.text).substr(0, lines.begin())), {}};
          TextLayout layout{source.text, named_columns(names->line, names->separator, names->number, units)};
          layout.separator = *separator;
          layout.begin = lines.begin();
          layout.end = source.text->size();
          layout.first_line = lines.number();
          settle_decimal_commas(layout, found);
          if (names->is_first && units.empty() && found.notes.empty() && found.format == "table" &&
              separator_of(trimmed(names->line)) == names->separator)
            return std::nullopt;  // TextTable reads it, with the entries in its comments
          found.sweeps.push_back({"", std::move(layout)});
          return found;
        }
        if (units.empty() && is_frequency_unit(fields[names->frequency])) {
          units = line;
          continue;
        }
      }
      names.reset();
      units = {};
    }
    if (lines.number() > most_lines_above) return std::nullopt;
    names = names_in(line, lines.number());
    if (names) names->is_first = is_first;
    is_first = false;
  }
  return std::nullopt;
}

std::optional<Recognised> read_numbered_table(const Source& source, std::size_t columns) {
  LineReader lines(*source.text);
  Fields fields, above;
  std::string_view line_above;
  std::size_t number_above = 0;
  for (std::string_view line; lines.next(line);) {
    const auto content = trimmed(line);
    if (content.empty() || is_comment(content)) continue;
    for (const char separator : separators) {
      split_by(content, separator, fields);
      const auto numbers = std::count_if(fields.begin(), fields.end(), [](std::string_view field) {
        return parse_number(field) || has_decimal_commas({field});
      });
      if (fields.size() < columns || numbers < 2) continue;
      Recognised found{"table", {}};
      TextLayout layout{source.text, {}};
      if (!line_above.empty()) layout.columns = named_columns(line_above, separator, number_above);
      if (layout.columns.size() != fields.size()) {
        layout.columns.clear();
        for (std::size_t i = 1; i <= fields.size(); ++i)
          layout.columns.push_back({"column " + std::to_string(i), lines.number(), column_in(line, fields[i - 1])});
      }
      layout.separator = separator;
      layout.begin = lines.begin();
      layout.end = source.text->size();
      layout.first_line = lines.number();
      settle_decimal_commas(layout, found);
      found.sweeps.push_back({"", std::move(layout)});
      return found;
    }
    line_above = line;
    number_above = lines.number();
  }
  return std::nullopt;
}

}  // namespace io
