// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>

#include "identification/statistics/autocorrelation.hpp"

namespace frac::detail {

/// Standard deviation of the smooth error that a measurement is taken to have, of the data: cables, calibration, drift.
inline constexpr double typical_smooth_error = 0.01;

/// What a model leaves of the data.
struct Leftover {
  double value;        // of its Schwarz criterion, n ln(cost/n) and the price of its parameters
  double rms;          // of the data
  double correlation;  // of neighbours
};

/// Evidence (twice the logarithm of odds) against a model that is taken to be the truth, by a rival that is not.  What
/// the truth leaves is noise and a smooth error.  So as many residuals carry news as their correlation leaves
/// independent; and where they are larger than noise, of the size of what the rival leaves, and a smooth error of usual
/// size make them together, each is the less likely for it.
/// @param residuals  count
[[nodiscard]] inline double evidence_against(const Leftover& held, const Leftover& rival, std::size_t residuals) {
  const double usual = rival.rms * rival.rms + typical_smooth_error * typical_smooth_error;
  const double beyond = static_cast<double>(residuals) * (held.rms * held.rms - rival.rms * rival.rms) / usual;
  return independent_share(held.correlation) * std::max(held.value - rival.value, beyond);
}

}  // namespace frac::detail
