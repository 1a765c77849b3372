// SPDX-License-Identifier: BSD-3-Clause
// Touchstone 1 (.s1p, .s2p, ...): "# <unit> <parameter> <form> R <ohm>" and records of a frequency and n*n pairs of
// numbers, comments after "!".  Parameters Z and Y are stored over R.  The noise table below a two-port is left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "io/data_error.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/number.hpp"

namespace io {
namespace {

struct Settings {
  double hertz = 1e9;  // per unit of frequency
  char parameter = 'S';
  std::string form = "MA";
  double resistance = 50;  // ohm
};

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; });
  return result;
}

// The line of options; empty where it holds other words.  One wrong word beside three right ones is an error, not
// another format.
std::optional<Settings> settings_of(const Source& source, std::size_t number, std::string_view line) {
  Settings settings;
  std::vector<std::string_view> wrong;
  std::vector<std::string_view> words;
  split_by(trimmed(line.substr(1)), ' ', words);
  bool is_told = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = upper(words[i]);
    constexpr std::array<std::pair<std::string_view, double>, 4> units{
        {{"HZ", 1}, {"KHZ", 1e3}, {"MHZ", 1e6}, {"GHZ", 1e9}}};
    const auto* const unit =
        std::find_if(units.begin(), units.end(), [&](const auto& each) { return each.first == word; });
    if (unit != units.end()) {
      settings.hertz = unit->second;
      is_told = true;
    } else if (word == "S" || word == "Y" || word == "Z") {
      settings.parameter = word.front();
    } else if (word == "RI" || word == "MA" || word == "DB") {
      settings.form = word;
      is_told = true;
    } else if (word == "R" && i + 1 < words.size()) {
      const auto resistance = parse_number(words[++i]);
      if (resistance && *resistance > 0 && std::isfinite(*resistance))
        settings.resistance = *resistance;
      else
        wrong.push_back(words[i]);
    } else {
      wrong.push_back(words[i]);
    }
  }
  if (wrong.size() == 1 && words.size() > 3 && is_told)
    throw DataError(
        source.file, number, column_in(line, wrong.front()),
        "found " + quoted(wrong.front()) +
            " in the line of options; expected '# UNIT PARAMETER FORM R OHM' with Hz, kHz, MHz or GHz, S, Y "
            "or Z, RI, MA or DB, and a resistance > 0");
  if (!wrong.empty()) return std::nullopt;
  return is_told ? std::optional(settings) : std::nullopt;
}

std::complex<double> value_of(const Settings& settings, double first, double second) {
  if (settings.form == "RI") return {first, second};
  const double magnitude = settings.form == "DB" ? std::pow(10, first / 20) : first;
  const double angle = second * std::numbers::pi / 180;
  return {magnitude * std::cos(angle), magnitude * std::sin(angle)};
}

struct Records {
  std::vector<double> numbers;      // of all records, one after another
  std::vector<std::size_t> begins;  // where each begins
  std::vector<std::size_t> lines;

  [[nodiscard]] std::size_t size() const { return begins.size(); }
  [[nodiscard]] std::size_t width(std::size_t i) const {
    return (i + 1 < size() ? begins[i + 1] : numbers.size()) - begins[i];
  }
  [[nodiscard]] const double* operator[](std::size_t i) const { return numbers.data() + begins[i]; }
};

[[noreturn]] void fail_at_word(const Source& source, std::size_t number, std::string_view line,
                               std::string_view content) {
  std::vector<std::string_view> words;
  split_by(content, ' ', words);
  const auto bad = std::find_if(words.begin(), words.end(), [](std::string_view word) {
    const auto value = parse_number(word);
    return !value || !std::isfinite(*value);
  });
  throw DataError(source.file, number, column_in(line, *bad), "found " + quoted(*bad) + "; expected a number");
}

// The records of the file: a line of an odd number of numbers begins one.
Records records_in(const Source& source, LineReader& lines) {
  Records records;
  for (std::string_view line; lines.next(line);) {
    const auto content = trimmed(line.substr(0, line.find('!')));
    if (content.empty() || content.starts_with('#')) continue;
    const std::size_t before = records.numbers.size();
    if (!append_numbers(content, records.numbers)) fail_at_word(source, lines.number(), line, content);
    if ((records.numbers.size() - before) % 2 == 1) {
      records.begins.push_back(before);
      records.lines.push_back(lines.number());
    } else if (records.size() == 0) {
      throw DataError(source.file, lines.number(), 1,
                      "found " + quoted(content) + "; expected a frequency and pairs of numbers");
    }
  }
  return records;
}

// "S21" of row 1 and column 0; "S1,13" of many ports, or (1,13) and (11,3) would have one name.
std::string element_name(char parameter, std::size_t row, std::size_t column, std::size_t ports) {
  return std::string(1, parameter) + std::to_string(row + 1) + (ports > 9 ? "," : "") + std::to_string(column + 1);
}

}  // namespace

std::optional<Recognised> read_touchstone(const Source& source) {
  LineReader lines(*source.text);
  std::optional<Settings> settings;
  for (std::string_view line; !settings && lines.next(line);) {
    const auto content = trimmed(line);
    if (content.empty() || content.starts_with('!')) continue;
    if (!content.starts_with('#')) return std::nullopt;
    settings = settings_of(source, lines.number(), content.substr(0, content.find('!')));
    if (!settings) return std::nullopt;
  }
  if (!settings) return std::nullopt;
  const Records records = records_in(source, lines);
  std::size_t count = records.size();
  if (count == 0) throw DataError(source.file, lines.number(), 0, "holds no data below its line of options");
  const std::size_t width = records.width(0);
  const auto ports = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(width - 1) / 2)));
  if (ports == 0 || 2 * ports * ports + 1 != width)
    throw DataError(
        source.file, records.lines.front(), 1,
        "found a record of " + std::to_string(width) + " numbers; expected a frequency and n*n pairs for n ports");
  Recognised found{"Touchstone", {}};
  for (std::size_t i = 1; i < count; ++i) {
    constexpr std::size_t numbers_of_noise = 5;
    if (ports == 2 && records.width(i) == numbers_of_noise && records[i][0] <= records[i - 1][0]) {
      found.notes.push_back("the noise table of " + std::to_string(count - i) + " rows is not used");
      count = i;
    } else if (records.width(i) != width) {
      throw DataError(source.file, records.lines[i], 1,
                      "found a record of " + std::to_string(records.width(i)) + " numbers; expected " +
                          std::to_string(width) + " as in line " + std::to_string(records.lines.front()));
    }
  }
  const double turn = 2 * std::numbers::pi * settings->hertz;
  const std::string unit = settings->parameter == 'Z' ? "ohm" : settings->parameter == 'Y' ? "S" : "1";
  const double scale = settings->parameter == 'Z'   ? settings->resistance
                       : settings->parameter == 'Y' ? 1 / settings->resistance
                                                    : 1;
  for (std::size_t row = 0; row < ports; ++row) {
    for (std::size_t column = 0; column < ports; ++column) {
      // Two-ports alone are written column by column.
      const std::size_t place = 1 + 2 * (ports == 2 ? column * 2 + row : row * ports + column);
      SampledCurve curve{{}, {}, unit, element_name(settings->parameter, row, column, ports)};
      for (std::size_t i = 0; i < count; ++i) {
        curve.omega.push_back(records[i][0] * turn);
        curve.value.push_back(scale * value_of(*settings, records[i][place], records[i][place + 1]));
      }
      found.sweeps.push_back({curve.quantity, std::move(curve)});
    }
  }
  if (ports == 1 && settings->parameter == 'S') {
    SampledCurve impedance = std::get<SampledCurve>(found.sweeps.front().content);
    impedance.quantity = "Z11";
    impedance.unit = "ohm";
    for (auto& value : impedance.value) value = settings->resistance * (1.0 + value) / (1.0 - value);
    found.sweeps.push_back({"Z11", std::move(impedance), true});
    found.notes.push_back("Z11, by --select, is the impedance " + format_number(settings->resistance) +
                          " ohm (1 + S)/(1 - S)");
  }
  return found;
}

}  // namespace io
