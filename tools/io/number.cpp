// SPDX-License-Identifier: BSD-3-Clause
#include "io/number.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace io {
namespace {

constexpr std::array powers_of_ten{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                   1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

constexpr std::array<std::uint64_t, 9> whole_powers{1, 10, 100, 1000, 10000, 100000, 1000000, 10000000, 100000000};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Eight characters, the first one lowest.
std::uint64_t eight_from(const char* at) {
  std::uint64_t eight = 0;
  for (unsigned i = 0; i < 8; ++i) eight |= static_cast<std::uint64_t>(static_cast<unsigned char>(at[i])) << (8 * i);
  return eight;
}

/// Takes the digits from a place of the text on into a whole number, up to eight at a time without a branch that hangs
/// on how many they are.
const char* take_digits(std::string_view text, const char* at, std::uint64_t& number) {
  const char* const end = text.data() + text.size();
  if (text.size() < 8) {
    for (; at != end && is_digit(*at); ++at) number = 10 * number + static_cast<std::uint64_t>(*at - '0');
    return at;
  }
  while (at != end) {
    const auto left = static_cast<unsigned>(std::min<std::ptrdiff_t>(end - at, 8));
    // Of the last characters those before them are shifted out.
    std::uint64_t eight = (left == 8 ? eight_from(at) : eight_from(end - 8) >> (8 * (8 - left))) ^ 0x3030303030303030U;
    // A digit has become its value, so that these bits are zero in it; of what is none only the first place counts.
    const std::uint64_t other = (eight | (eight + 0x0606060606060606U)) & 0xF0F0F0F0F0F0F0F0U;
    const auto count = static_cast<unsigned>(std::countr_zero(other)) / 8;
    if (count == 0) break;
    eight <<= 8 * (8 - count);
    // Pairs of digits, then their sum with the weights 10^6, 10^4, 100 and 1.
    eight = eight * 10 + (eight >> 8U);
    eight = ((eight & 0x000000FF000000FFU) * (100 + (std::uint64_t{1000000} << 32U)) +
             ((eight >> 16U) & 0x000000FF000000FFU) * (1 + (std::uint64_t{10000} << 32U))) >>
            32U;
    number = number * whole_powers[count] + eight;
    at += count;
    if (count < 8) break;
  }
  return at;
}

/// Numbers as instruments write them: whole text below 2^53 without point, times or over a power of ten up to 1e22.
/// Both are doubles, so that their product or quotient is the nearest one (Clinger 1990).  False for all other texts.
bool take_short_decimal(std::string_view text, double& value) {
  constexpr std::size_t longest = 18;  // what is longer has more digits than that as a rule
  if (text.size() > longest) return false;
  const char* at = text.data();
  const char* const end = at + text.size();
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  std::uint64_t digits = 0;  // of 18 characters at most, which fit into 64 bits
  const char* const first = at;
  for (; at != end && is_digit(*at); ++at) digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
  std::ptrdiff_t count = at - first, exponent = 0;
  if (at != end && *at == '.') {
    const char* const point = ++at;
    at = take_digits(text, at, digits);
    exponent = point - at;
    count -= exponent;
  }
  if (count == 0 || digits > (std::uint64_t{1} << 53U)) return false;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool is_small = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    if (at == end || end - at > 3) return false;
    int written = 0;
    for (; at != end && is_digit(*at); ++at) written = 10 * written + (*at - '0');
    exponent += is_small ? -written : written;
  }
  constexpr auto largest = static_cast<std::ptrdiff_t>(powers_of_ten.size()) - 1;
  if (at != end || exponent > largest || exponent < -largest) return false;
  value = static_cast<double>(digits);
  if (exponent < 0)
    value /= powers_of_ten[static_cast<std::size_t>(-exponent)];
  else
    value *= powers_of_ten[static_cast<std::size_t>(exponent)];
  if (negative) value = -value;
  return true;
}

std::optional<double> any_decimal(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (text.empty()) return std::nullopt;
  if (stop != end) {
    // Fortran writes 1.0D+00.
    const auto mark = static_cast<std::size_t>(stop - text.data());
    if (mark == 0 || (*stop != 'D' && *stop != 'd')) return std::nullopt;
    std::string usual(text);
    usual[mark] = 'e';
    return any_decimal(usual);
  }
  if (error == std::errc{}) return value;
  // from_chars leaves the value untouched beyond the range of a double; strtod tells overflow from underflow.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  return std::nullopt;
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
  double value = 0;
  if (take_short_decimal(text, value)) return value;
  return any_decimal(text);
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
