// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace backlash::detail {

/// Root of f on [a, b], where it has the values fa and fb of different signs, by regula falsi with halving of the end
/// that stays (Illinois), bisection where that is slow.  Empty where f is, at a point asked for.
template <typename Function>
std::optional<double> bracketed_root(double a, double b, double fa, double fb, const Function& f) {
  if (fa == 0) return a;
  if (fb == 0) return b;
  for (int iteration = 0; iteration < 200; ++iteration) {
    double x = iteration % 4 == 3 ? 0.5 * (a + b) : b - fb * (b - a) / (fb - fa);
    if (!(x > std::min(a, b) && x < std::max(a, b))) x = 0.5 * (a + b);
    if (x == a || x == b || std::abs(b - a) <= 1e-15 * std::max(std::abs(a), std::abs(b))) return x;
    const std::optional<double> value = f(x);
    if (!value) return std::nullopt;
    if (*value == 0) return x;
    if ((*value < 0) != (fb < 0)) {
      a = b;
      fa = fb;
    } else {
      fa *= 0.5;
    }
    b = x;
    fb = *value;
    if (std::abs(b - a) < 1e-14) return b;
  }
  return b;
}

}  // namespace backlash::detail
