// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace frac::detail {

/// ln|a/b|, also where the ratio leaves the range of a double.
[[nodiscard]] inline double log_ratio(double a, double b) {
  const double ratio = std::abs(a / b);
  return std::isnormal(ratio) ? std::log(ratio) : std::log(std::abs(a)) - std::log(std::abs(b));
}

}  // namespace frac::detail
