// SPDX-License-Identifier: BSD-3-Clause
#include "frac/parameter_units.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <optional>

#include "dimension_analysis.hpp"

namespace frac {
namespace {

constexpr double rounding = 1e-7;  // of exponents that differences give

/// An exponent as a number and a multiple of each order: 1 - n of s^(1 - n).
struct AffineExponent {
  double constant = 0;
  std::vector<double> by_order;  // per parameter
};

bool is_number(const AffineExponent& exponent) {
  return std::all_of(exponent.by_order.begin(), exponent.by_order.end(), [](double each) { return each == 0; });
}

/// Takes exponents for multiples of a twelfth; there is none for others.
std::optional<double> simple_number(double value) {
  const double twelfths = std::round(12 * value);
  if (!(std::abs(12 * value - twelfths) < rounding)) return std::nullopt;
  return twelfths / 12;
}

std::string number_of(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

/// "n", "-n", "2 n - 1", "1 - n"
std::string text_of(const AffineExponent& exponent, const std::vector<std::string>& names) {
  std::string text;
  const auto add = [&](double factor, const std::string& name) {
    if (factor == 0) return;
    text += text.empty() ? (factor < 0 ? "-" : "") : factor < 0 ? " - " : " + ";
    const double size = std::abs(factor);
    if (name.empty() || size != 1) text += number_of(size);
    if (!name.empty()) text += (size != 1 ? " " : "") + name;
  };
  if (exponent.constant > 0) add(exponent.constant, "");
  for (std::size_t k = 0; k < names.size(); ++k) add(exponent.by_order[k], names[k]);
  if (exponent.constant < 0) add(exponent.constant, "");
  return text;
}

bool is_one_word(std::string_view unit) {
  return std::all_of(unit.begin(), unit.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x80 || std::isalnum(byte) != 0;
  });
}

/// A power of a unit: "ohm^-1", "N/m" of "m/N" to the power -1, "(m/N)^2".
std::string power_of(const std::string& unit, const AffineExponent& exponent, const std::vector<std::string>& names) {
  const bool is_plain = is_number(exponent);
  if (is_plain && exponent.constant == 0) return {};
  if (is_plain && exponent.constant == 1) return unit;
  const std::size_t slash = unit.find('/');
  if (is_plain && exponent.constant == -1 && slash != std::string::npos && slash > 0) {
    const std::string above = unit.substr(0, slash), below = unit.substr(slash + 1);
    if (is_one_word(above) && is_one_word(below) && !below.empty()) return below + "/" + above;
  }
  std::string text = text_of(exponent, names);
  if (text.find(' ') != std::string::npos) text = "(" + text + ")";
  return (is_one_word(unit) ? unit : "(" + unit + ")") + "^" + text;
}

/// Exponents of every parameter as functions of the orders, found from their values at several sets of orders.
std::vector<std::optional<AffineExponent>> exponents_of(const Structure& structure,
                                                        std::optional<double> detail::KnownDimension::*exponent) {
  const std::size_t count = structure.parameter_names().size();
  // Orders in no simple relation, where terms are alike by their form alone.
  std::vector<double> at(count);
  for (std::size_t k = 0; k < count; ++k)
    at[k] = 0.3 + 0.6 * std::fmod(0.6180339887498949 * static_cast<double>(k + 1), 1);
  const auto known = detail::known_dimensions(structure, at);
  std::vector<std::optional<AffineExponent>> found(count);
  for (std::size_t i = 0; i < count; ++i)
    if (known[i].*exponent) found[i] = {0, std::vector<double>(count, 0.0)};
  constexpr double step = 0.25;
  std::vector<double> beyond = at;
  for (std::size_t k = 0; k < count; ++k) {
    if (structure.parameter_roles()[k] != ParameterRole::order) continue;
    std::vector<double> moved = at;
    moved[k] += step;
    beyond[k] += step * static_cast<double>(k + 2);
    const auto there = detail::known_dimensions(structure, moved);
    for (std::size_t i = 0; i < count; ++i) {
      if (!found[i]) continue;
      const auto slope =
          there[i].*exponent ? simple_number((*(there[i].*exponent) - *(known[i].*exponent)) / step) : std::nullopt;
      if (slope)
        found[i]->by_order[k] = *slope;
      else
        found[i].reset();
    }
  }
  const auto far = detail::known_dimensions(structure, beyond);
  for (std::size_t i = 0; i < count; ++i) {
    if (!found[i]) continue;
    double here = *(known[i].*exponent), there = 0;
    for (std::size_t k = 0; k < count; ++k) {
      here -= found[i]->by_order[k] * at[k];
      there += found[i]->by_order[k] * beyond[k];
    }
    const auto constant = simple_number(here);
    // Exponents that are no straight lines over the orders, as that of 1/n, are not written.
    if (constant && far[i].*exponent && std::abs(*constant + there - *(far[i].*exponent)) < rounding)
      found[i]->constant = *constant;
    else
      found[i].reset();
  }
  return found;
}

}  // namespace

std::vector<std::string> parameter_units(const Structure& structure, std::string_view value_unit) {
  const std::vector<std::string>& names = structure.parameter_names();
  const auto of_value = exponents_of(structure, &detail::KnownDimension::value_exponent);
  const auto of_frequency = exponents_of(structure, &detail::KnownDimension::frequency_exponent);
  const std::string unit(value_unit);
  std::vector<std::string> units(names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (structure.parameter_roles()[i] == ParameterRole::order) {
      units[i] = "1";
      continue;
    }
    if (!of_frequency[i] || (!of_value[i] && unit != "1")) continue;
    const AffineExponent plain{0, std::vector<double>(names.size(), 0.0)};
    const AffineExponent value = unit == "1" ? plain : *of_value[i];
    const bool has_value = !is_number(value) || value.constant != 0;
    if (has_value && unit.empty()) continue;
    AffineExponent time = *of_frequency[i];
    const bool is_frequency = !has_value && is_number(time) && time.constant == 1;
    time.constant = 0 - time.constant;
    for (double& each : time.by_order) each = 0 - each;
    const std::string in_value = power_of(unit, value, names), in_time = power_of("s", time, names);
    // A factor behind a slash would read as a divisor.
    const bool time_first = in_value.find('/') != std::string::npos;
    units[i] = is_frequency                          ? "rad/s"
               : in_value.empty() && in_time.empty() ? "1"
               : in_value.empty() || in_time.empty() ? in_value + in_time
               : time_first                          ? in_time + " " + in_value
                                                     : in_value + " " + in_time;
  }
  return units;
}

}  // namespace frac
