// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdlib>
#include <string>

#include "base/short_text.hpp"

namespace frac::detail {

/// A bound in so many significant digits: no smaller than the value, and less than one unit of the last digit above it.
[[nodiscard]] inline std::string bound_text(double value, int digits = 3) {
  const auto read = [](const std::string& text) { return std::strtod(text.c_str(), nullptr); };
  const std::string nearest = short_text(value, digits);
  if (!(read(nearest) < value)) return nearest;
  // Half a unit above the value the nearest number is the next one up.
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - (digits - 1));
  return short_text(read(nearest) + unit, digits);
}

}  // namespace frac::detail
