// SPDX-License-Identifier: BSD-3-Clause
#include "io/number.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace io {
namespace {

constexpr std::array powers_of_ten{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Numbers as instruments write them: whole text below 2^53 without point, times or over a power of ten up to 1e22.
/// Both are doubles, so that their product or quotient is the nearest one (Clinger 1990).  Nothing for all other texts.
std::optional<double> short_decimal(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  constexpr std::ptrdiff_t most_digits = 18;  // fit into 64 bits
  std::uint64_t digits = 0;
  const char* const first = at;
  for (; at != end && is_digit(*at); ++at) digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
  std::ptrdiff_t count = at - first, exponent = 0;
  if (at != end && *at == '.') {
    const char* const point = ++at;
    for (; at != end && is_digit(*at); ++at) digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
    exponent = point - at;
    count -= exponent;
  }
  if (count == 0 || count > most_digits || digits > (std::uint64_t{1} << 53U)) return std::nullopt;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool is_small = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    if (at == end || end - at > 3) return std::nullopt;
    int written = 0;
    for (; at != end && is_digit(*at); ++at) written = 10 * written + (*at - '0');
    exponent += is_small ? -written : written;
  }
  constexpr auto largest = static_cast<std::ptrdiff_t>(powers_of_ten.size()) - 1;
  if (at != end || exponent > largest || exponent < -largest) return std::nullopt;
  auto value = static_cast<double>(digits);
  if (exponent < 0)
    value /= powers_of_ten[static_cast<std::size_t>(-exponent)];
  else
    value *= powers_of_ten[static_cast<std::size_t>(exponent)];
  return negative ? -value : value;
}

}  // namespace

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
  if (const auto number = short_decimal(text)) return number;
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
