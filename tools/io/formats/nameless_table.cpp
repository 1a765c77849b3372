// SPDX-License-Identifier: BSD-3-Clause
// Three columns of numbers without names: a frequency and two that are told by Bode's relation.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "io/bode_relation.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/number.hpp"

namespace io {
namespace {

using Fields = std::vector<std::string_view>;

bool are_numbers(const Fields& fields) {
  return std::all_of(fields.begin(), fields.end(),
                     [](std::string_view field) { return parse_number(field) || has_decimal_commas({field}); });
}

/// What a line may be that stands above rows: names of columns, which say something even where no reader knows them.
bool may_be_names(std::string_view line) {
  Fields fields;
  for (const char separator : {'\t', ';', ',', ' '}) {
    split_by(line, separator, fields);
    if ((fields.size() == 3 || (fields.size() > 3 && separator != ' ')) && !holds_a_number(fields)) return true;
  }
  return false;
}

/// The rows where they are all that follows, be it below lines of another kind.
std::optional<TextLayout> rows_of_three(const Source& source) {
  TextLayout layout{source.text, {}};
  LineReader lines(*source.text);
  std::string_view above;
  Fields fields;
  std::size_t rows = 0;
  for (std::string_view line; lines.next(line);) {
    const auto content = trimmed(line);
    if (content.empty()) continue;
    char found = '\0';
    for (const char separator : {'\t', ';', ',', ' '}) {
      split_by(content, separator, fields);
      if (fields.size() == 3 && are_numbers(fields)) found = separator;
      if (fields.size() > 1 && are_numbers({fields.front()}) && found == '\0' && separator != ' ') return std::nullopt;
      if (found != '\0') break;
    }
    if (found == '\0') {
      if (rows > 0) return std::nullopt;
      above = is_comment(content) ? trimmed(content.substr(1)) : content;
      continue;
    }
    if (rows++ == 0) {
      if (may_be_names(above)) return std::nullopt;
      layout.separator = found;
      layout.begin = lines.begin();
      layout.first_line = lines.number();
    } else if (layout.separator != found) {
      return std::nullopt;
    }
    layout.end = std::min(lines.after(), source.text->size());
  }
  if (rows == 0) return std::nullopt;
  return layout;
}

struct Reading {
  std::string first, second;
  std::optional<double> departure;
  double phase;  // sum
};

}  // namespace

std::optional<Recognised> read_nameless_table(const Source& source) {
  auto layout = rows_of_three(source);
  if (!layout) return std::nullopt;
  Recognised found{"table", {}};
  settle_decimal_commas(*layout, found);
  std::vector<std::array<double, 3>> rows;
  LineReader lines(std::string_view(*layout->text).substr(0, layout->end));
  lines.skip_to(layout->begin);
  Fields fields;
  for (std::string_view line; lines.next(line);) {
    if (trimmed(line).empty()) continue;
    split_by(trimmed(line), layout->separator, fields);
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < row.size(); ++i) row[i] = parse_number(fields[i]).value_or(std::nan(""));
  }
  if (rows.front()[0] > rows.back()[0]) std::reverse(rows.begin(), rows.end());
  std::vector<double> omega;
  for (const auto& [frequency, first, second] : rows) {
    if (!(frequency > (omega.empty() ? 0 : omega.back())) || !std::isfinite(first + second)) return std::nullopt;
    omega.push_back(frequency);
  }
  std::vector<Reading> readings;
  const auto read = [&](const char* first, const char* second, const auto& value_of) {
    std::vector<std::complex<double>> values;
    double phase = 0;
    for (const auto& row : rows) {
      values.push_back(value_of(row));
      phase += std::arg(values.back());
    }
    readings.push_back({first, second, departure_from_bode(omega, values), phase});
  };
  const auto lies_within = [&](std::size_t column, double limit) {
    return std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return std::abs(row[column]) <= limit; });
  };
  const bool may_be_phases = lies_within(2, 360), may_be_decibels = lies_within(1, 400);
  const bool is_positive = std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row[1] > 0; });
  for (const double sign : {1.0, -1.0}) {
    read("re", sign > 0 ? "im" : "-im", [&](const auto& row) { return std::complex(row[1], sign * row[2]); });
    const char* const phase = sign > 0 ? "phase (deg)" : "-phase (deg)";
    const auto polar = [&](double magnitude, double degrees) {
      return std::polar(magnitude, sign * degrees * std::numbers::pi / 180);
    };
    if (may_be_phases && is_positive) read("magnitude", phase, [&](const auto& row) { return polar(row[1], row[2]); });
    if (may_be_phases && may_be_decibels)
      read("magnitude (dB)", phase, [&](const auto& row) { return polar(std::pow(10, row[1] / 20), row[2]); });
  }
  std::erase_if(readings, [](const Reading& reading) { return !reading.departure; });
  if (readings.size() < 2) return std::nullopt;
  std::sort(readings.begin(), readings.end(),
            [](const Reading& a, const Reading& b) { return a.departure < b.departure; });
  const Reading& best = readings.front();
  // Parts with a positive phase may be a modulus, whose
  // frequencies are mostly in rad/s, which numbers do not tell.
  const bool may_be_modulus = best.first == "re" && best.phase > 0;
  if (*best.departure > agrees_with_bode || *readings[1].departure < clearly_beside_bode * *best.departure ||
      may_be_modulus)
    return std::nullopt;
  for (const std::string& name : {std::string("f"), best.first, best.second})
    layout->columns.push_back({name, layout->first_line, 1});
  found.notes.push_back("columns have no names; by Bode's relation of magnitude and phase they are f, " + best.first +
                        ", " + best.second + "; --columns says what else they are");
  found.sweeps.push_back({"", *std::move(layout)});
  return found;
}

}  // namespace io
