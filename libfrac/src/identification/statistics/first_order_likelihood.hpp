// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace frac::detail {

/// Noise of first order, e_i = r e_(i-1) + white with 0 <= r < 1, as one series of residuals has it most likely.
struct FirstOrderNoise {
  double correlation;  // r
  double logarithm;    // of the likelihood, its variance most likely too; a constant of the count alone is left out
};
/// @param residual  at least 2
[[nodiscard]] FirstOrderNoise first_order_likelihood(std::span<const double> residual);

}  // namespace frac::detail
