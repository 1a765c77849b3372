// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <span>

namespace frac::detail {

/// sum taps_k z^-k at z = 1 + delta.
[[nodiscard]] inline std::complex<double> response_of_taps(std::span<const double> taps, std::complex<double> delta) {
  const std::complex<double> back = 1.0 / (1.0 + delta);
  std::complex<double> sum = 0;
  for (auto tap = taps.rbegin(); tap != taps.rend(); ++tap) sum = sum * back + *tap;
  return sum;
}

/// z - 1 at z = e^{j omega T}, without cancellation at low frequency.
[[nodiscard]] inline std::complex<double> delta_at(double omega, double sample_time) {
  const double half = omega * sample_time / 2;
  return 2 * std::sin(half) * std::complex<double>(-std::sin(half), std::cos(half));
}

}  // namespace frac::detail
