#pragma once

#include <cmath>

namespace backlash::detail {

/// Functions of a time h in radians by which motion under a sine force is written.
struct Arcs {
  double one_minus_cos;
  double sin;
  double h_minus_sin;
};

/// Below 1/2, where 1 - cos h and h - sin h cancel, by Taylor series; the first term left out is below 1e-17 of the
/// sum.
[[gnu::always_inline]] inline Arcs arcs(double h) noexcept {
  if (std::abs(h) < 0.5) {
    const double x = h * h;
    const double one_minus_cos =
        0.5 * x *
        (1 - x * (1.0 / 12) *
                 (1 - x * (1.0 / 30) *
                          (1 - x * (1.0 / 56) * (1 - x * (1.0 / 90) * (1 - x * (1.0 / 132) * (1 - x * (1.0 / 182)))))));
    const double h_minus_sin =
        h * x * (1.0 / 6) *
        (1 -
         x * (1.0 / 20) *
             (1 - x * (1.0 / 42) *
                      (1 - x * (1.0 / 72) * (1 - x * (1.0 / 110) * (1 - x * (1.0 / 156) * (1 - x * (1.0 / 210)))))));
    return {one_minus_cos, h - h_minus_sin, h_minus_sin};
  }
  const double s = std::sin(h);
  const double c = std::cos(h);
  return {1 - c, s, h - s};
}

}  // namespace backlash::detail
