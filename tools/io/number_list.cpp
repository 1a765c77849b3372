// SPDX-License-Identifier: BSD-3-Clause
#include "io/number_list.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "io/data_error.hpp"
#include "io/fields.hpp"
#include "io/number.hpp"

namespace io {
namespace {

constexpr std::size_t largest_count = 10'000'000;

[[noreturn]] void fail(std::string_view what, const std::string& message) {
  throw std::invalid_argument(std::string(what) + ": " + message);
}

std::vector<std::string_view> parts_of(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const auto end = text.find(separator, begin);
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

double finite_number(std::string_view text, std::string_view what, const std::string& place) {
  const auto value = parse_number(text);
  if (!value) fail(what, quoted(text) + " (" + place + ") is no number");
  if (!std::isfinite(*value)) fail(what, quoted(text) + " (" + place + ") must be a finite number");
  return *value;
}

std::size_t grid_count(std::string_view text, std::string_view what) {
  const auto value = parse_number(text);
  const auto count = io::parse_count(text);
  if (!value || (!count && *value <= largest_count))
    fail(what, quoted(text) + " (count) must be a whole number, as in 5:35:200 or 5:35:200log");
  if (!count || *count < 2 || *count > largest_count)
    fail(what, "count " + std::string(text) + " must lie between 2 and " + std::to_string(largest_count) +
                   "; a single value is written alone, as in 5");
  return *count;
}

}  // namespace

std::vector<double> parse_list(std::string_view text, std::string_view what) {
  if (trimmed(text).empty()) fail(what, "the list is empty; expected numbers such as 10,20,30");
  std::vector<double> values;
  for (const auto part : parts_of(text, ','))
    values.push_back(finite_number(part, what, "entry " + std::to_string(values.size() + 1)));
  return values;
}

std::vector<double> parse_grid(std::string_view text, std::string_view what) {
  if (trimmed(text).empty())
    fail(what, "the grid is empty; expected FROM:TO:COUNT, FROM:TO:COUNTlog or a list such as 5,10,20");
  if (text.find(':') == std::string_view::npos) return parse_list(text, what);
  auto parts = parts_of(text, ':');
  if (parts.size() != 3)
    fail(what,
         quoted(text) + " has " + std::to_string(parts.size()) + " parts; expected FROM:TO:COUNT or FROM:TO:COUNTlog");
  const bool logarithmic = parts[2].ends_with("log");
  if (logarithmic) parts[2].remove_suffix(3);
  const double from = finite_number(parts[0], what, "from");
  const double to = finite_number(parts[1], what, "to");
  const std::size_t count = grid_count(parts[2], what);
  if (!(from < to)) fail(what, "from " + format_number(from) + " must be less than to " + format_number(to));
  if (logarithmic && !(from > 0)) fail(what, "from " + format_number(from) + " must be > 0 on a logarithmic grid");

  std::vector<double> values(count);
  const double log_from = logarithmic ? std::log(from) : 0;
  const double log_to = logarithmic ? std::log(to) : 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count - 1);
    values[i] = logarithmic ? std::exp(std::lerp(log_from, log_to, share)) : std::lerp(from, to, share);
  }
  values.front() = from;
  values.back() = to;
  return values;
}

}  // namespace io
