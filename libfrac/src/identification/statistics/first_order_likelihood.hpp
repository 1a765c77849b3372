// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace frac::detail {

/// Noise of first order, e_i = r e_(i-1) + white with 0 <= r < 1, as one series of residuals has it most likely.
struct FirstOrderNoise {
  double correlation;  // r
  double logarithm;    // of the likelihood, its variance most likely too; a constant of the count alone is left out
};
/// @param logarithm  of the likelihood of r, for so many values.  Its peak has the width 1/sqrt(count) in Fisher's z =
///                   atanh r, and even steps of a third of it miss at most 1/72.
template <class Logarithm>
[[nodiscard]] FirstOrderNoise likeliest_noise(double count, const Logarithm& logarithm) {
  const double last = std::atanh(0.999), step = std::min(0.05, 1 / (3 * std::sqrt(count)));
  FirstOrderNoise best{0, logarithm(0)};
  for (double z = step; z < last; z += step) {
    const double r = std::tanh(z), here = logarithm(r);
    if (here > best.logarithm) best = {r, here};
  }
  return best;
}
/// @param residual  at least 2
[[nodiscard]] FirstOrderNoise first_order_likelihood(std::span<const double> residual);

}  // namespace frac::detail
