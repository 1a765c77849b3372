// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace backlash::detail {

/// Functions of a time h in radians by which motion under a sine force is written.
struct Arcs {
  double one_minus_cos;
  double sin;
  double h_minus_sin;
};

/// Below 1/2, where 1 - cos h and h - sin h cancel, by Taylor series, in pieces that a processor works on side by side;
/// the first term left out is below 1e-17 of the sum.
[[gnu::always_inline]] inline Arcs arcs(double h) noexcept {
  if (std::abs(h) < 0.5) {
    const double x = h * h;
    const double y = x * x;
    const double one_minus_cos = x * (((1.0 / 2) - x * (1.0 / 24)) +
                                      y * (((1.0 / 720) - x * (1.0 / 40320)) +
                                           y * (((1.0 / 3628800) - x * (1.0 / 479001600)) + y * (1.0 / 87178291200))));
    const double h_minus_sin = h * x *
                               (((1.0 / 6) - x * (1.0 / 120)) +
                                y * (((1.0 / 5040) - x * (1.0 / 362880)) +
                                     y * (((1.0 / 39916800) - x * (1.0 / 6227020800)) + y * (1.0 / 1307674368000))));
    return {one_minus_cos, h - h_minus_sin, h_minus_sin};
  }
  const double s = std::sin(h);
  const double c = std::cos(h);
  return {1 - c, s, h - s};
}

}  // namespace backlash::detail
