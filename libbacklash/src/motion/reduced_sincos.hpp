// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace backlash::detail {

struct SinCos {
  double sin;
  double cos;
};

/// Sine and cosine of |x| <= pi/4 to 0.6 ulp, without a call: the minimax polynomials of fdlibm (Sun Microsystems 1993,
/// k_sin.c and k_cos.c; absolute errors below 2^-58), in even and odd halves that a processor works on side by side.
[[gnu::always_inline]] inline SinCos sincos_of_small(double x) noexcept {
  const double z = x * x;
  const double w = z * z;
  const double sine = (-1.66666666666666324348e-01 + z * 8.33333333332248946124e-03) +
                      w * ((-1.98412698298579493134e-04 + z * 2.75573137070700676789e-06) +
                           w * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10));
  const double cosine = (4.16666666666666019037e-02 + z * -1.38888888888741095749e-03) +
                        w * ((2.48015872894767294178e-05 + z * -2.75573143513906633035e-07) +
                             w * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11));
  const double half = 0.5 * z;
  const double near_one = 1 - half;
  return {x + x * z * sine, near_one + (((1 - near_one) - half) + w * cosine)};
}

/// Sine and cosine of |x| <= pi/2 to 1 ulp, both with full relative precision.
[[gnu::always_inline]] inline SinCos reduced_sincos(double x) noexcept {
  constexpr double quarter_pi = 0.78539816339744830962;
  constexpr double half_pi = 1.57079632679489661923;
  constexpr double half_pi_low = 6.1232339957367658860e-17;  // pi/2 - double(pi/2)
  const double size = std::abs(x);
  const bool is_steep = size > quarter_pi;
  const SinCos found = sincos_of_small(is_steep ? (half_pi - size) + half_pi_low : size);
  return {std::copysign(is_steep ? found.cos : found.sin, x), is_steep ? found.sin : found.cos};
}

}  // namespace backlash::detail
