// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

namespace frac::detail {

/// d/d ln p of ln((1 + j omega p)/(p + j omega)), with full relative precision in both parts: the derivative by the
/// order of a pole that goes to infinity multiplies it with as large a number.
[[nodiscard]] inline std::complex<double> ladder_sensitivity(double omega, double pole) {
  const double q = omega * pole;
  const double r = omega / pole;
  const double imaginary = 1 / (q + 1 / q) + 1 / (r + 1 / r);
  if (pole > 1) return {1 / (1 + 1 / (r * r)) - 1 / (1 + q * q), imaginary};
  return {1 / (1 + 1 / (q * q)) - 1 / (1 + r * r), imaginary};
}

}  // namespace frac::detail
