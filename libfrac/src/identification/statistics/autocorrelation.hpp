// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "frac/identification/model_choice.hpp"

namespace frac::detail {

/// Autocorrelation of `stride` interleaved series at a lag, pooled; 0 where all values are 0.
[[nodiscard]] inline double autocorrelation(std::span<const double> values, std::size_t stride, std::size_t lag) {
  double power = 0, product = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    power += values[i] * values[i];
    if (i >= stride * lag) product += values[i] * values[i - stride * lag];
  }
  return power > 0 ? product / power : 0;
}

/// The share of the values that carry news where neighbours are correlated by r: (1 - r)/(1 + r), at most 1.
[[nodiscard]] inline double independent_share(double correlation) {
  const double r = std::clamp(correlation, 0.0, 0.999);
  return (1 - r) / (1 + r);
}

/// Whether `stride` interleaved series of residuals look like noise.
[[nodiscard]] ResidualWhiteness whiteness(std::span<const double> residual, std::size_t stride);

}  // namespace frac::detail
