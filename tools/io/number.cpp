// SPDX-License-Identifier: BSD-3-Clause
#include "io/number.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace io {

std::string format_number(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

void append_number(std::string& text, double value) {
  if (std::isnan(value)) {
    text += "nan";  // to_chars would keep the sign bit: "-nan"
    return;
  }
  std::array<char, 32> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text.append(buffer.data(), end);
}

std::optional<double> parse_number(std::string_view text) {
  if (text.starts_with('+') && text.size() > 1 && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || text.empty()) return std::nullopt;
  if (error == std::errc{}) return value;
  // from_chars leaves the value untouched beyond the range of a double; strtod tells overflow from underflow.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  return std::nullopt;
}

bool is_number(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const auto next_is = [&](char wanted) { return at != end && *at == wanted; };
  const auto skip_digits = [&] {
    const char* const begin = at;
    while (at != end && '0' <= *at && *at <= '9') ++at;
    return at != begin;
  };
  if (next_is('-')) ++at;
  bool is_decimal = skip_digits();
  if (next_is('.')) {
    ++at;
    is_decimal = skip_digits() || is_decimal;
  }
  if (next_is('e')) {
    ++at;
    if (next_is('-') || next_is('+')) ++at;
    is_decimal = skip_digits() && is_decimal;
  }
  return (is_decimal && at == end) || parse_number(text).has_value();
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t count = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, count);
  if (stop == end && error == std::errc{} && !text.empty()) return count;
  constexpr double first_gap = 9007199254740992;  // 2^53: every whole number up to here is a double
  const auto value = parse_number(text);
  if (!value || !(*value >= 0 && *value < first_gap) || std::floor(*value) != *value) return std::nullopt;
  return static_cast<std::uint64_t>(*value);
}

}  // namespace io
