// SPDX-License-Identifier: BSD-3-Clause
// Universal file, dataset 58: functions at nodal degrees of freedom, as text or (58b) in binary.  Datasets stand
// between lines "    -1"; of them the frequency responses (function type 4) are taken.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "io/data_error.hpp"
#include "io/decoded_text.hpp"
#include "io/fields.hpp"
#include "io/formats/format.hpp"
#include "io/number.hpp"

namespace io {
namespace {

constexpr std::size_t head_lines = 11;
constexpr int frequency_response = 4;

// Place of the binary values and how they are written.
struct BinaryForm {
  bool big_endian = false;
  std::size_t bytes = 0;
};

// The lines of a dataset before its values.
struct Head {
  std::size_t line = 0;  // of the first
  std::array<std::string, head_lines> lines;

  // A fixed column of a line, without blanks.
  [[nodiscard]] std::string_view field(std::size_t row, std::size_t begin, std::size_t width) const {
    const std::string& text = lines[row - 1];
    return begin < text.size() ? trimmed(std::string_view(text).substr(begin, width)) : std::string_view();
  }
};

struct Numbers {
  bool is_complex = false, is_double = false, is_even = false;
  std::size_t points = 0;
  double first = 0, step = 0;
};

class Reader {
 public:
  explicit Reader(const Source& source) : source_(source), lines_(source.bytes) {}

  [[nodiscard]] std::optional<Recognised> read() {
    std::string_view line;
    if (!next_filled(line) || trimmed(line) != "-1") return std::nullopt;
    if (!next_filled(line) || !is_dataset_58(line)) {
      // Other datasets may stand before the first of ours.
      if (source_.bytes.find("\n    58") == std::string_view::npos || !parse_count(trimmed(line))) return std::nullopt;
    }
    do {
      if (is_dataset_58(line)) {
        read_dataset(line);
      } else {
        while (trimmed(line) != "-1" && lines_.next(line)) {
        }
      }
    } while (next_dataset(line));
    finish();
    return std::move(found_);
  }

 private:
  [[noreturn]] void fail(std::size_t line, const std::string& message) const {
    throw DataError(source_.file, line, 0, message);
  }

  bool next_filled(std::string_view& line) {
    while (lines_.next(line))
      if (!trimmed(line).empty()) return true;
    return false;
  }

  // To the number of the next dataset, after its opening -1.
  bool next_dataset(std::string_view& line) { return next_filled(line) && trimmed(line) == "-1" && next_filled(line); }

  static bool is_dataset_58(std::string_view line) {
    const auto kind = trimmed(line.substr(0, 7));
    return kind == "58" || kind == "58b";
  }

  [[nodiscard]] BinaryForm binary_form(std::string_view line) const {
    std::vector<std::string_view> words;
    split_by(trimmed(line), ' ', words);
    const auto number = [&](std::size_t i) { return i < words.size() ? parse_count(words[i]) : std::nullopt; };
    const auto order = number(1), form = number(2), rows = number(3), bytes = number(4);
    if (!order || !form || !rows || !bytes || (*order != 1 && *order != 2) || *rows != head_lines)
      fail(lines_.number(), "found " + quoted(line) + "; expected '58b', byte order, form of numbers, 11 and bytes");
    if (*form != 2) fail(lines_.number(), "numbers are not those of IEEE 754; expected form 2");
    return {*order == 2, static_cast<std::size_t>(*bytes)};
  }

  void read_dataset(std::string_view line) {
    ++count_;
    const bool is_binary = trimmed(line.substr(0, 7)) == "58b";
    const BinaryForm form = is_binary ? binary_form(line) : BinaryForm{};
    Head head;
    head.line = lines_.number() + 1;
    for (auto& text : head.lines) {
      if (!lines_.next(line)) fail(lines_.number(), "ends within the head of a dataset 58; the file is cut off");
      text = *decoded(std::make_shared<const std::string>(line)).text;
    }
    const auto type = parse_count(head.field(6, 0, 5));
    if (!type) fail(head.line + 5, "found " + quoted(head.field(6, 0, 5)) + "; expected the type of the function");
    if (*type != frequency_response) ++others_;
    const Numbers numbers = numbers_of(head);
    std::vector<double> values;
    if (is_binary)
      read_binary(form, numbers, values);
    else
      read_text(numbers, values);
    if (*type == frequency_response) add(head, numbers, values);
  }

  [[nodiscard]] Numbers numbers_of(const Head& head) const {
    const auto kind = parse_count(head.field(7, 0, 10)), points = parse_count(head.field(7, 10, 10)),
               spacing = parse_count(head.field(7, 20, 10));
    const auto first = parse_number(head.field(7, 30, 13)), step = parse_number(head.field(7, 43, 13));
    if (!kind || (*kind != 2 && *kind != 4 && *kind != 5 && *kind != 6) || !points || *points == 0 || !spacing ||
        !first || !step)
      fail(head.line + 6, "found " + quoted(head.lines[6]) + "; expected type and number of values and their spacing");
    // Each value takes a byte at least, so more than that cannot follow.
    if (*points > source_.bytes.size())
      fail(head.line + 6, "declares " + std::to_string(*points) + " points; the file has " +
                              std::to_string(source_.bytes.size()) + " bytes");
    return {*kind >= 5, *kind == 4 || *kind == 6, *spacing == 1, static_cast<std::size_t>(*points), *first, *step};
  }

  static std::size_t per_point(const Numbers& numbers) {
    return (numbers.is_even ? 0U : 1U) + (numbers.is_complex ? 2U : 1U);
  }

  // Numbers may touch each other, so their columns count; where a line does not keep them, its blanks do.
  void read_text(const Numbers& numbers, std::vector<double>& values) {
    const std::size_t wanted = numbers.points * per_point(numbers);
    values.reserve(wanted);
    std::vector<std::string_view> words;
    for (std::string_view line; values.size() < wanted;) {
      if (!lines_.next(line) || trimmed(line) == "-1")
        fail(lines_.number(), "ends after " + std::to_string(values.size() / per_point(numbers)) + " of " +
                                  std::to_string(numbers.points) + " points; the file is cut off");
      if (append_numbers(line, values)) continue;
      cut_into_columns(line, numbers, values.size(), words);
      for (const auto word : words) {
        const auto number = parse_number(word);
        if (!number || !std::isfinite(*number)) fail(lines_.number(), "found " + quoted(word) + "; expected a number");
        values.push_back(*number);
      }
    }
    std::string_view end;
    // Some writers fill the last line with zeros.
    if (std::any_of(values.begin() + static_cast<std::ptrdiff_t>(wanted), values.end(),
                    [](double v) { return v != 0; }))
      fail(lines_.number(), "holds more values than its head declares");
    values.resize(wanted);
    if (next_filled(end) && trimmed(end) != "-1") fail(lines_.number(), "found " + quoted(end) + "; expected '-1'");
  }

  static void cut_into_columns(std::string_view line, const Numbers& numbers, std::size_t before,
                               std::vector<std::string_view>& words) {
    constexpr std::size_t narrow = 13, wide = 20;
    words.clear();
    for (std::size_t at = 0; at < line.size();) {
      const bool is_abscissa = !numbers.is_even && (before + words.size()) % per_point(numbers) == 0;
      const std::size_t width = numbers.is_double && !is_abscissa ? wide : narrow;
      const auto word = trimmed(line.substr(at, width));
      if (!word.empty()) words.push_back(word);
      at += width;
    }
  }

  void read_binary(const BinaryForm& form, const Numbers& numbers, std::vector<double>& values) {
    const std::size_t begin = lines_.after(), count = numbers.points * per_point(numbers);
    const std::size_t width = numbers.is_double ? 8 : 4;
    if (begin + form.bytes > source_.bytes.size())
      fail(lines_.number(), "declares " + std::to_string(form.bytes) + " bytes of values; the file has " +
                                std::to_string(source_.bytes.size() - std::min(begin, source_.bytes.size())) +
                                " more: it is cut off");
    // Values of eight bytes stand behind an abscissa of four or of eight.
    const bool is_mixed = !numbers.is_even && width == 8 && form.bytes == count * width - 4 * numbers.points;
    if (form.bytes != count * width && !is_mixed)
      fail(lines_.number(), "declares " + std::to_string(form.bytes) + " bytes of values; expected " +
                                std::to_string(count * width) + " for " + std::to_string(numbers.points) + " points");
    const char* at = source_.bytes.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t bytes = is_mixed && i % per_point(numbers) == 0 ? 4 : width;
      values.push_back(binary_number(at, bytes, form.big_endian));
      at += bytes;
    }
    lines_.skip_to(begin + form.bytes);
    std::string_view end;
    if (next_filled(end) && trimmed(end) != "-1") fail(lines_.number(), "expected '-1' after the values");
    if (const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
        bad != values.end())
      fail(lines_.number(), "value " + std::to_string(bad - values.begin() + 1) + " of the dataset is not finite");
  }

  static double binary_number(const char* bytes, std::size_t width, bool big_endian) {
    std::array<unsigned char, 8> raw{};
    std::memcpy(raw.data(), bytes, width);
    static_assert(std::endian::native == std::endian::little);
    if (big_endian) std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(width));
    if (width == 4) {
      float value = 0;
      std::memcpy(&value, raw.data(), sizeof value);
      return static_cast<double>(value);
    }
    double value = 0;
    std::memcpy(&value, raw.data(), sizeof value);
    return value;
  }

  // "12 +X": node and direction.
  static std::string degree_of_freedom(std::string_view node, std::string_view direction) {
    constexpr std::array<std::string_view, 6> axes{"X", "Y", "Z", "RX", "RY", "RZ"};
    const bool is_negative = direction.starts_with('-');
    const auto axis = parse_count(is_negative ? direction.substr(1) : direction);
    const bool is_known = axis && *axis >= 1 && *axis <= axes.size();
    return std::string(node.empty() ? "0" : node) +
           (is_known ? (is_negative ? "-" : "+") + std::string(axes[*axis - 1]) : "");
  }

  // Response over reference, e.g. "5+Z/2+Z".
  static std::string name_of(const Head& head) {
    return degree_of_freedom(head.field(6, 41, 10), head.field(6, 51, 4)) + "/" +
           degree_of_freedom(head.field(6, 66, 10), head.field(6, 76, 4));
  }

  // Of the ordinate's numerator over its denominator, e.g. "m/N" or "(m/s^2)/N".
  static std::string unit_of(const Head& head) {
    const auto told = [&head](std::size_t line) {
      const std::string_view unit = head.field(line, 46, 20);
      return std::string(unit == "NONE" ? "" : unit);
    };
    const std::string over = told(9), under = told(10);
    if (under.empty()) return over;
    const bool is_ratio = over.find('/') != std::string::npos;
    return (over.empty() ? "1" : is_ratio ? "(" + over + ")" : over) + "/" + under;
  }

  void add(const Head& head, const Numbers& numbers, const std::vector<double>& values) {
    const std::string frequency_unit(head.field(8, 46, 20));
    const auto shown_in = frequency_unit == "rad/s" ? frac::FrequencyUnit::rad_per_s : frac::FrequencyUnit::hertz;
    const double turn = shown_in == frac::FrequencyUnit::hertz ? 2 * std::numbers::pi : 1;
    if (frequency_unit.empty() || frequency_unit == "NONE")
      found_.notes.push_back("set " + std::to_string(count_) + " gives no unit of frequency; Hz is taken");
    else if (frequency_unit != "Hz" && frequency_unit != "hz" && frequency_unit != "HZ" && frequency_unit != "rad/s")
      fail(head.line + 7, "found the unit " + quoted(frequency_unit) + " of frequency; expected Hz or rad/s");
    SampledCurve curve{{}, {}, unit_of(head), "response", shown_in};
    const std::size_t stride = per_point(numbers), shift = numbers.is_even ? 0 : 1;
    for (std::size_t i = 0; i < numbers.points; ++i) {
      const double* const at = values.data() + i * stride;
      curve.omega.push_back(turn * (numbers.is_even ? numbers.first + static_cast<double>(i) * numbers.step : at[0]));
      curve.value.emplace_back(at[shift], numbers.is_complex ? at[shift + 1] : 0.0);
    }
    found_.sweeps.push_back({name_of(head), std::move(curve)});
  }

  void finish() {
    if (others_ > 0)
      found_.notes.push_back(std::to_string(others_) + (others_ == 1 ? " set is" : " sets are") +
                             " no frequency response and not used");
    if (found_.sweeps.empty())
      fail(0, "is a universal file without a frequency response; expected a dataset 58 of function type 4");
    std::map<std::string, int> met;
    for (auto& sweep : found_.sweeps)
      if (const int times = ++met[sweep.name]; times > 1) sweep.name += " (" + std::to_string(times) + ")";
  }

  const Source& source_;
  LineReader lines_;
  Recognised found_{"universal file, dataset 58", {}};
  std::size_t count_ = 0, others_ = 0;
};

}  // namespace

std::optional<Recognised> read_universal58(const Source& source) {
  return Reader(source).read();
}

}  // namespace io
