// SPDX-License-Identifier: BSD-3-Clause
#include "io/record_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "frac/records/excitation.hpp"
#include "io/decoded_text.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/input_text.hpp"
#include "io/number.hpp"
#include "io/unit_name.hpp"

namespace io {
namespace {

/// Named signals, wherever they come from.
struct Signals {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;
  Metadata metadata;
};

struct Column {
  std::string base, unit;  // lower case, as written
};

// "force_n", "force [N]", "y2 (m)".
Column column_of(std::string_view name) {
  const auto bracket = name.find_first_of("[(");
  Column column;
  if (bracket != std::string_view::npos) {
    column.base = trimmed(name.substr(0, bracket));
    const auto end = name.find_first_of("])", bracket);
    column.unit = trimmed(name.substr(bracket + 1, std::min(end, name.size()) - bracket - 1));
  } else {
    column.base = unit_apart(name).name;
    if (column.base.size() < name.size()) column.unit = name.substr(column.base.size() + 1);
    for (const std::string_view unit : {"_ms", "_us", "_min", "_h", "_a", "_v", "_rad"})
      if (column.unit.empty() && name.size() > unit.size() && name.ends_with(unit)) {
        column.base = name.substr(0, name.size() - unit.size());
        column.unit = unit.substr(1);
      }
  }
  std::transform(column.base.begin(), column.base.end(), column.base.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return column;
}

bool is_one_of(std::string_view base, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), base) != words.end();
}

// "y", "y2", "output_1".
bool names_output(std::string base) {
  while (!base.empty() && (std::isdigit(static_cast<unsigned char>(base.back())) != 0 || base.back() == '_'))
    base.pop_back();
  return is_one_of(base, {"output", "y", "position"});
}

std::string key_of(std::string_view name) {
  const std::string base = column_of(name).base;
  if (is_one_of(base, {"time", "t"})) return "time";
  if (is_one_of(base, {"input", "u", "force"})) return "input";
  if (is_one_of(base, {"reference", "ref"})) return "reference";
  return names_output(base) ? "output" : "";
}

double seconds_per(const std::string& file, const std::string& name, const std::string& unit,
                   std::vector<std::string>& notes) {
  if (unit.empty()) {
    notes.push_back("column " + quoted(name) + " has no unit and is taken as s");
    return 1;
  }
  constexpr std::array<std::pair<std::string_view, double>, 6> units{
      {{"s", 1}, {"sec", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}, {"h", 3600}}};
  for (const auto& [spelled, seconds] : units)
    if (unit == spelled) return seconds;
  throw DataError(file, 0, 0,
                  "column " + quoted(name) + ": found the unit " + quoted(unit) + "; expected s, ms, us, min or h");
}

Signals signals_of_table(const std::string& file, const std::shared_ptr<const std::string>& text,
                         const std::vector<std::pair<std::string, std::string>>& told,
                         std::vector<std::string>& notes) {
  const TextTable table(file, text);
  Signals signals;
  signals.metadata = table.metadata();
  std::vector<bool> is_wanted;
  std::optional<std::size_t> event;
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    const std::string name(table.header()[i].text);
    signals.names.push_back(name);
    if (name == "event") event = i;
    is_wanted.push_back(!key_of(name).empty() || std::any_of(told.begin(), told.end(), [&](const auto& each) {
      return each.second == name || each.second == std::to_string(i + 1);
    }));
  }
  signals.values.resize(signals.names.size());
  // Vectors that grow hold up to three times as much.
  const auto lines = static_cast<std::size_t>(std::count(text->begin(), text->end(), '\n'));
  for (std::size_t i = 0; i < signals.values.size(); ++i)
    if (is_wanted[i]) signals.values[i].reserve(lines);
  std::size_t left_out = 0;
  table.for_each_row([&](const TextTable::Row& row) {
    if (event && row.fields[*event] != "sample") {
      ++left_out;
      return;
    }
    for (std::size_t i = 0; i < row.fields.size(); ++i) {
      if (!is_wanted[i]) continue;
      const auto value = parse_number(row.fields[i]);
      if (!value || !std::isfinite(*value))
        throw DataError(
            file, row.line, row.column_of(i),
            "found " + quoted(row.fields[i]) + " in column " + quoted(signals.names[i]) + "; expected a finite number");
      signals.values[i].push_back(*value);
    }
  });
  if (left_out > 0) notes.push_back(std::to_string(left_out) + " rows of other events than sample are left out");
  return signals;
}

Signals signals_in(const std::string& file, const std::vector<std::pair<std::string, std::string>>& told,
                   std::vector<std::string>& notes) {
  const auto bytes = input_text(file);
  const DecodedText text = decoded(bytes);
  if (const auto vectors = matlab_vectors({file, *bytes, text.text})) {
    Signals signals;
    for (const auto& vector : *vectors) {
      if (vector.is_complex) continue;
      signals.names.push_back(vector.name);
      auto& values = signals.values.emplace_back();
      for (const auto& value : vector.values) values.push_back(value.real());
    }
    return signals;
  }
  return signals_of_table(file, text.text, told, notes);
}

struct Clock {
  double step = 0;  // s
  std::vector<frac::RecordGap> gaps = {};
  const std::vector<double>* time = nullptr;  // null: told by its step alone
  double seconds = 1;                         // per unit of the times

  /// Steps from the first sample to each.
  [[nodiscard]] std::vector<std::ptrdiff_t> places() const {
    std::vector<std::ptrdiff_t> found(time->size());
    auto gap = gaps.begin();
    std::size_t place = 0;
    for (std::size_t i = 0; i < found.size(); ++i, ++place) {
      if (gap != gaps.end() && gap->before == i) place += (gap++)->missing;
      found[i] = static_cast<std::ptrdiff_t>(place);
    }
    return found;
  }
};

/// Step of times that rise by equal steps, but for samples that are missing.
Clock clock_of(const std::string& file, const std::vector<double>& time, double seconds,
               std::vector<std::string>& notes) {
  if (time.size() < 2)
    throw DataError(file, 0, 0, "found " + std::to_string(time.size()) + " samples; expected at least 16");
  std::vector<double> steps;
  // Of a long record some tell their middle.
  const std::size_t stride = 1 + time.size() / (1 << 17);
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (!(time[i] > time[i - 1]))
      throw DataError(file, 0, 0,
                      "sample " + std::to_string(i + 1) + " has the time " + format_number(time[i]) + " after " +
                          format_number(time[i - 1]) + "; expected times that rise");
    if (i % stride == 0) steps.push_back(time[i] - time[i - 1]);
  }
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  // A missing sample makes a step of two.  The mean of the others, in which jitter cancels but at the ends of
  // stretches, tells how many samples are missing in a long gap; then all of the record tells the step.
  constexpr double most_steps = 1.5, most_beside = 0.25, longest = 1e9;
  const double most = most_steps * *middle;
  double sum = 0, count = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double length = time[i] - time[i - 1];
    sum += length <= most ? length : 0;
    count += length <= most ? 1 : 0;
  }
  Clock clock;
  double missing = 0;
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double length = time[i] - time[i - 1];
    if (length <= most) continue;
    const double steps_of_gap = std::max(2.0, std::round(length * count / sum));
    clock.gaps.push_back({i, static_cast<std::size_t>(std::min(steps_of_gap, longest)) - 1});
    missing += steps_of_gap - 1;
  }
  const double step = (time.back() - time.front()) / (static_cast<double>(time.size() - 1) + missing);
  for (const frac::RecordGap& gap : clock.gaps) {
    const double length = time[gap.before] - time[gap.before - 1];
    if (std::abs(length / step - static_cast<double>(gap.missing + 1)) > most_beside)
      throw DataError(
          file, 0, 0,
          "a gap of " + format_number(std::round(100 * length * count / sum) / 100) + " steps of " +
              format_number(sum / count * seconds) + " s stands before sample " + std::to_string(gap.before + 1) +
              "; expected equal steps, a gap of a whole number of them, or a file for each side of the gap");
  }
  double squares = 0;
  std::size_t place = 0, gap = 0;
  for (std::size_t i = 0; i < time.size(); ++i, ++place) {
    if (gap < clock.gaps.size() && clock.gaps[gap].before == i) place += clock.gaps[gap++].missing;
    const double late = (time[i] - time.front()) / step - static_cast<double>(place);
    squares += late * late;
    if (std::abs(late) > 0.5)
      throw DataError(file, 0, 0,
                      "sample " + std::to_string(i + 1) + " is " + format_number(std::round(1000 * late) / 1000) +
                          " steps of " + format_number(step * seconds) +
                          " s off its place: the clock drifts; expected equal steps, or --sample-time");
  }
  const double jitter = std::sqrt(squares / static_cast<double>(time.size()));
  constexpr double rounding = 1e-3;
  if (jitter > rounding)
    notes.push_back("the clock jitters by " + format_number(std::round(1e4 * jitter) / 1e4) +
                    " of a step (rms); samples are taken at equal steps");
  clock.step = step * seconds;
  clock.time = &time;
  clock.seconds = seconds;
  return clock;
}

using Told = std::vector<std::pair<std::string, std::string>>;

/// A file, and what is told of its columns.
class SignalFile {
 public:
  SignalFile(const std::string& file, const Told& told, std::vector<std::string>& notes)
      : shown(file == "-" ? "standard input" : file), signals(signals_in(file, told, notes)), told_(told) {}

  [[nodiscard]] std::vector<std::size_t> columns_for(const std::string& key) const;
  /// Of its times, where no step is told in their place.
  [[nodiscard]] Clock clock(const std::optional<double>& sample_time, std::vector<std::string>& notes) const;
  [[nodiscard]] DataError missing(const std::string& what, const std::string& names) const {
    return {shown, 0, 0,
            "no " + what + " among " + shortened_list(signals.names) + "; expected " + names +
                ", or --columns such as time=1,input=2,output=3"};
  }

  std::string shown;
  Signals signals;

 private:
  const Told& told_;
};

std::vector<std::size_t> SignalFile::columns_for(const std::string& key) const {
  std::vector<std::size_t> found;
  bool is_told = false;
  for (const auto& [told_key, column] : told_) {
    if (told_key != key) continue;
    is_told = true;
    const auto number = parse_count(column);
    const auto by_name = std::find(signals.names.begin(), signals.names.end(), column);
    const auto place = by_name != signals.names.end() ? static_cast<std::size_t>(by_name - signals.names.begin())
                       : number                       ? static_cast<std::size_t>(*number) - 1
                                                      : signals.names.size();
    if (place >= signals.names.size())
      throw DataError(shown, 0, 0,
                      "has no column " + quoted(column) + " as --columns says; it has " +
                          std::to_string(signals.names.size()) + ": " + shortened_list(signals.names));
    found.push_back(place);
  }
  // A MAT-file may hold one period of the reference, or settings, beside the samples.
  std::size_t longest = 0;
  for (const auto& values : signals.values) longest = std::max(longest, values.size());
  if (!is_told)
    for (std::size_t i = 0; i < signals.names.size(); ++i)
      if (key_of(signals.names[i]) == key && signals.values[i].size() == longest &&
          std::none_of(told_.begin(), told_.end(), [&](const auto& each) { return each.second == signals.names[i]; }))
        found.push_back(i);
  if (key != "output" && found.size() > 1)
    throw DataError(shown, 0, 0,
                    "columns " + quoted(signals.names[found[0]]) + " and " + quoted(signals.names[found[1]]) +
                        " both name the " + key + "; expected one of them, or --columns");
  return found;
}

Clock SignalFile::clock(const std::optional<double>& sample_time, std::vector<std::string>& notes) const {
  if (sample_time) return {*sample_time};
  const auto time = columns_for("time");
  if (time.empty()) throw missing("time column", "time_s or t, --sample-time");
  const std::string& name = signals.names[time[0]];
  return clock_of(shown, signals.values[time[0]], seconds_per(shown, name, column_of(name).unit, notes), notes);
}

/// Rows of two files side by side.
struct JoinedRows {
  std::vector<std::size_t> here, there;
  std::vector<frac::RecordGap> gaps;
  double earlier = 0;  // s, by which instants here are before those there
};

/// Those whose instants are nearer than half a step.
JoinedRows joined_rows(const SignalFile& here, const Clock& clock, const SignalFile& there, const Clock& other) {
  const auto both = static_cast<double>(std::min(clock.time->size(), other.time->size()));
  if (std::abs(other.step / clock.step - 1) * both > 0.5)
    throw DataError(there.shown, 0, 0,
                    "has steps of " + format_number(other.step) + " s and " + here.shown + " of " +
                        format_number(clock.step) +
                        " s, which run apart by more than half a step over the record; expected one clock");
  const auto instant = [](const Clock& of, std::size_t row) { return (*of.time)[row] * of.seconds; };
  const double shift = std::round((instant(other, 0) - instant(clock, 0)) / clock.step);
  JoinedRows rows;
  if (std::abs(shift) < 1e9) {
    const auto places = clock.places(), others = other.places();
    const auto from = static_cast<std::ptrdiff_t>(shift);
    std::ptrdiff_t before = 0;
    for (std::size_t i = 0, j = 0; i < places.size() && j < others.size();) {
      const std::ptrdiff_t place = others[j] + from;
      if (places[i] != place) {
        ++(places[i] < place ? i : j);
        continue;
      }
      if (!rows.here.empty() && place > before + 1)
        rows.gaps.push_back({rows.here.size(), static_cast<std::size_t>(place - before - 1)});
      before = place;
      rows.earlier += instant(other, j) - instant(clock, i);
      rows.here.push_back(i++);
      rows.there.push_back(j++);
    }
  }
  if (rows.here.empty())
    throw DataError(there.shown, 0, 0,
                    "has no instant in common with " + here.shown + ": it begins at " +
                        format_number(instant(other, 0)) + " s, and that at " + format_number(instant(clock, 0)) +
                        " s; expected times of one clock");
  rows.earlier /= static_cast<double>(rows.here.size());
  return rows;
}

void keep_rows(std::vector<double>& values, const std::vector<std::size_t>& rows) {
  for (std::size_t i = 0; i < rows.size(); ++i) values[i] = values[rows[i]];
  values.resize(rows.size());
}

}  // namespace

std::vector<std::pair<std::string, std::string>> record_columns_told(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t begin = 0; begin < text.size();) {
    const auto end = std::min(text.find(',', begin), text.size());
    const std::string part(trimmed(std::string_view(text).substr(begin, end - begin)));
    const auto sign = part.find('=');
    const std::string key = part.substr(0, sign), column = sign == std::string::npos ? "" : part.substr(sign + 1);
    if (!is_one_of(key, {"time", "input", "output", "reference", "trigger"}) || column.empty() || column == "0")
      throw std::invalid_argument("--columns " + quoted(part) +
                                  ": expected KEY=COLUMN, a column by its number from 1 or its name; keys are time, "
                                  "input, output, reference and trigger");
    for (const auto& [other, of_other] : pairs)
      if ((other == key && key != "output") || of_other == column)
        throw std::invalid_argument("--columns " + quoted(part) + ": " + (other == key ? key : column) +
                                    " is given twice");
    pairs.emplace_back(key, column);
    begin = end + 1;
  }
  return pairs;
}

RecordFile read_record(const std::string& file, const RecordReadOptions& options) {
  const auto told = record_columns_told(options.columns);
  std::vector<std::string> notes;
  SignalFile table(file, told, notes);
  Signals& signals = table.signals;
  Clock clock = table.clock(options.sample_time, notes);
  const auto time = table.columns_for("time"), outputs = table.columns_for("output"),
             references = table.columns_for("reference");
  const auto triggers = std::any_of(told.begin(), told.end(), [](const auto& each) { return each.first == "trigger"; })
                            ? table.columns_for("trigger")
                            : std::vector<std::size_t>{};
  if (outputs.empty()) throw table.missing("output", "output or y");
  std::string input_name, input_unit;
  std::vector<double> input;
  double sensor_delay = 0;
  const auto take_input = [&](SignalFile& from) {
    const auto inputs = from.columns_for("input");
    if (inputs.empty()) return false;
    input_name = from.signals.names[inputs[0]];
    input_unit = column_of(input_name).unit;
    input = std::move(from.signals.values[inputs[0]]);
    return true;
  };
  if (!options.input_file.empty()) {
    SignalFile other(options.input_file, told, notes);
    const Clock of_input = other.clock(options.sample_time, notes);
    if (!take_input(other)) throw other.missing("input", "input, u or force");
    if (clock.time != nullptr) {
      JoinedRows rows = joined_rows(table, clock, other, of_input);
      const std::size_t alone = clock.time->size() + of_input.time->size() - 2 * rows.here.size();
      if (alone > 0)
        notes.push_back(std::to_string(alone) + " rows of it and of " + other.shown +
                        " have none of the other beside them and are left out");
      constexpr double rounding = 1e-3;
      if (std::abs(rows.earlier) > rounding * clock.step) {
        sensor_delay = rows.earlier;
        notes.push_back("instants are " + format_number(std::round(1e4 * rows.earlier / clock.step) / 1e4) +
                        " of a step before those of " + other.shown + ", which is taken out of the response");
      }
      keep_rows(input, rows.there);
      for (const auto& columns : {outputs, references, triggers})
        for (const std::size_t each : columns) keep_rows(signals.values[each], rows.here);
      clock.gaps = std::move(rows.gaps);
    }
  } else if (take_input(table)) {
    if (!time.empty()) signals.values[time[0]] = {};
  } else if (!triggers.empty()) {
    input_name = "cosine of " + signals.names[triggers[0]];
  } else {
    const auto number_of = [&](std::string_view key) {
      const auto text = find_value(signals.metadata, key);
      return text ? parse_number(*text) : std::nullopt;
    };
    const auto force = number_of("force_n"), omega = number_of("omega_rad_s");
    if (!force || !omega || time.empty()) throw table.missing("input", "input, u or force");
    input_name = "F cos(w t)";
    input_unit = "n";
    for (const double at : signals.values[time[0]]) input.push_back(*force * std::cos(*omega * at));
    notes.push_back("the input is F cos(w t) with force_n and omega_rad_s of the head");
  }
  std::vector<std::vector<double>> values;
  std::vector<std::string> names, units;
  for (const auto each : outputs) {
    names.push_back(signals.names[each]);
    const std::string unit = column_of(names.back()).unit;
    units.push_back(unit.empty() || input_unit.empty() ? "" : unit + "_per_" + input_unit);
    values.push_back(std::move(signals.values[each]));
  }
  try {
    std::vector<double> instants;
    if (!triggers.empty()) {
      if (!clock.gaps.empty())
        throw DataError(table.shown, 0, 0, "has gaps, over which a trigger is not followed; expected none");
      instants = frac::trigger_instants(signals.values[triggers[0]]);
    }
    const bool has_input = !input.empty();
    if (!has_input) input = frac::cosine_of(instants, values.front());
    frac::Record record(clock.step, std::move(input), std::move(values),
                        references.empty() ? std::vector<double>{} : std::move(signals.values[references[0]]),
                        std::move(clock.gaps));
    std::optional<double> period;
    if (has_input && !instants.empty() && frac::excitation_of(record) != frac::Excitation::stepped_sine) {
      period = frac::period_of(record.drive(), instants);
      if (period)
        *period *= clock.step;
      else
        notes.emplace_back(
            "the trigger does not come at equal distances, to within a sample: no period is taken of it");
    }
    return {std::move(record),           input_name,       std::move(names), std::move(input_unit), std::move(units),
            std::move(signals.metadata), std::move(notes), period,           sensor_delay};
  } catch (const std::invalid_argument& error) {
    throw DataError(table.shown, 0, 0, error.what());
  }
}

}  // namespace io
