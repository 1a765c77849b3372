// SPDX-License-Identifier: BSD-3-Clause
#include "io/time_series_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "io/column_name.hpp"
#include "io/number.hpp"

namespace io {
namespace {

struct NameParts {
  std::string base;  // lower case
  std::string unit;  // as written
};

// "time_s", "time [s]", "t(s)", "y": the unit stands in brackets or after the first underscore.
NameParts parts_of(std::string_view name) {
  const std::size_t mark = name.find_first_of("_[( ");
  NameParts parts{std::string(name.substr(0, mark)), ""};
  std::transform(parts.base.begin(), parts.base.end(), parts.base.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (mark == std::string_view::npos) return parts;
  for (const char c : name.substr(mark)) {
    if (std::string_view("_[]() ").find(c) == std::string_view::npos) parts.unit += c;
  }
  return parts;
}

std::optional<double> seconds_per(const std::string& unit) {
  if (unit.empty() || unit == "s" || unit == "sec" || unit == "seconds") return 1;
  if (unit == "ms") return 1e-3;
  if (unit == "us") return 1e-6;
  if (unit == "min") return 60;
  if (unit == "h") return 3600;
  return std::nullopt;
}

bool is_time(std::string_view name) {
  const std::string base = parts_of(name).base;
  return base == "time" || base == "t";
}

bool is_input(std::string_view name) {
  const std::string base = parts_of(name).base;
  return base == "input" || base == "u";
}

bool is_output(std::string_view name) {
  const std::string base = parts_of(name).base;
  return base == "output" || base == "y";
}

using Test = bool (*)(std::string_view);

std::optional<std::size_t> column_with(const TextTable& table, Test test) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    if (!test(table.header()[i].text)) continue;
    if (found) {
      const auto& field = table.header()[i];
      throw DataError(table.file(), field.line, field.column,
                      "column " + quoted(field.text) + ": means the same as column " +
                          quoted(table.header()[*found].text) + "; expected one of them");
    }
    found = i;
  }
  return found;
}

std::size_t required(const TextTable& table, Test test, const std::string& what, const std::string& names) {
  const auto column = column_with(table, test);
  if (column) return *column;
  const auto& first = table.header().front();
  throw DataError(table.file(), first.line, first.column,
                  "no " + what + " among the columns " + column_list(table) + "; expected " + names);
}

struct Columns {
  std::size_t time, input;
  std::optional<std::size_t> output, sigma;
  double seconds = 1;  // per unit of time
};

Columns columns_of(const TextTable& table, bool with_output, std::vector<std::string>& notes) {
  Columns columns{};
  columns.time = required(table, is_time, "time column", "time_s, t_s, time or t");
  columns.input = required(table, is_input, "input", "input or u");
  if (with_output) {
    columns.output = required(table, is_output, "output", "output or y");
    columns.sigma = column_with(table, names_standard_deviation);
  }
  const auto& name = table.header()[columns.time];
  const std::string unit = parts_of(name.text).unit;
  const auto seconds = seconds_per(unit);
  if (!seconds) {
    throw DataError(
        table.file(), name.line, name.column,
        "column " + quoted(name.text) + ": found the unit " + quoted(unit) + "; expected s, ms, us, min or h");
  }
  columns.seconds = *seconds;
  if (unit.empty()) notes.push_back("column " + quoted(name.text) + " has no unit and is taken as s");
  std::vector<std::string> unused;
  for (std::size_t i = 0; i < table.header().size(); ++i) {
    if (i == columns.time || i == columns.input || i == columns.output || i == columns.sigma) continue;
    unused.emplace_back(table.header()[i].text);
  }
  if (!unused.empty()) notes.push_back("columns not used: " + shortened_list(unused));
  return columns;
}

TimeSeries read(const std::string& file, bool with_output, const std::vector<SampleFilter>& where) {
  const TextTable table(file);
  const RowFilter row_filter(table, where);
  TimeSeries series;
  series.metadata = table.metadata();
  const Columns columns = columns_of(table, with_output, series.notes);
  table.for_each_row([&](const TextTable::Row& row) {
    const auto fail = [&](std::size_t field, const std::string& expected) {
      throw DataError(
          file, row.line, row.column_of(field),
          "found " + quoted(row.fields[field]) + " in column " + quoted(table.header()[field].text) + "; " + expected);
    };
    const auto number = [&](std::size_t field) {
      const auto text = row.fields[field];
      const auto value = parse_number(text);
      if (value && std::isfinite(*value)) return *value;
      if (value) fail(field, "expected a finite number");
      if (text.empty()) fail(field, "expected a number, the field is empty");
      if (text.find(',') != std::string_view::npos) fail(field, "expected a number with a decimal point, such as 1.5");
      fail(field, "expected a number");
      return 0.0;
    };
    const double time = number(columns.time) * columns.seconds;
    if (!series.time.empty() && !(time > series.time.back()))
      fail(columns.time,
           "expected a time after " + format_number(series.time.back() / columns.seconds) + " of the row before");
    series.time.push_back(time);
    series.input.push_back(number(columns.input));
    if (columns.output) series.output.push_back(number(*columns.output));
    const double output = columns.output ? series.output.back() : 0;
    if (row_filter(row) && std::all_of(where.begin(), where.end(), [&](const SampleFilter& filter) {
          return filter(time, series.input.back(), output);
        }))
      series.kept.push_back(series.time.size() - 1);
    if (!columns.sigma) return;
    series.sigma.push_back(number(*columns.sigma));
    if (!(series.sigma.back() > 0)) fail(*columns.sigma, "a standard deviation must be > 0");
  });
  return series;
}

}  // namespace

bool holds_time_response(const std::string& file, const MeasurementOptions& how) {
  const Measurement measurement = read_measurement(file, how);
  if (!measurement.format.empty()) return false;
  const TextTable& table = *measurement.sweeps.front().table;
  bool has_time = false, has_output = false, has_frequency = false;
  for (const auto& field : table.header()) {
    has_time = has_time || is_time(field.text);
    has_output = has_output || is_output(field.text);
    has_frequency = has_frequency || column_meaning(field.text).quantity == Quantity::frequency;
  }
  return has_time && has_output && !has_frequency;
}

TimeSeries read_time_response(const std::string& file, const std::vector<SampleFilter>& where) {
  return read(file, true, where);
}

TimeSeries read_input_signal(const std::string& file) {
  return read(file, false, {});
}

frac::TimeResponseData time_response_data(const std::string& file, TimeSeries series, frac::Hold hold,
                                          double input_at_rest) {
  constexpr std::size_t fewest = 2;
  if (series.time.size() < fewest)
    throw DataError(
        file, 0, 0,
        (series.time.empty() ? "found no sample" : "found one sample") + std::string("; expected at least two"));
  if (std::all_of(series.input.begin(), series.input.end(), [&](double value) { return value == input_at_rest; }))
    throw DataError(file, 0, 0,
                    "the input is " + format_number(input_at_rest) +
                        " throughout, as at rest: nothing drives the system; expected an input that differs from its "
                        "value at rest (--input-at-rest of fit and identify, 0 if not given)");
  try {
    return {std::move(series.time), std::move(series.input), std::move(series.output), std::move(series.sigma), hold,
            input_at_rest};
  } catch (const std::invalid_argument& error) {
    throw DataError(file, 0, 0, error.what());  // samples that the hold has no meaning for
  }
}

}  // namespace io
