// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace frac::detail {

/// weight e^{-rate (k - first)}, rate per sample.
struct WeightExponential {
  double rate;
  double weight;
};

/// Positive exponentials that stand for the Gruenwald-Letnikov weights of order -b from index `first` on.
struct WeightExponentials {
  std::vector<WeightExponential> terms;  // by falling rate
  double error_bound;                    // |sum/w_k - 1| on first <= k <= horizon, rounding apart; below the tolerance
};

/// From w_k = (sin(pi b)/pi) int_0^inf e^{-s(k+b)} (1 - e^{-s})^{-b} ds by the trapezoidal rule in ln s.  Of its points
/// those with s horizon below a few units are a geometric sequence s_c q^j with weights (q^(1-b))^j, the measure of the
/// little q-Jacobi polynomials: a few Gauss points of it take the place of all of them, however slowly they decay.
/// @param b  0 < b < 1.
[[nodiscard]] WeightExponentials weight_exponentials(double b, std::size_t first, double tolerance, double horizon);

}  // namespace frac::detail
