// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "identification/statistics/autocorrelation.hpp"

namespace frac::detail {

/// Standard deviation of the smooth error that a measurement is taken to have, of the data: cables, calibration and
/// drift leave a per cent, but averaging that has brought the noise down to less than a tenth of that is seldom done on
/// data with so much of it; computed data have none.  It is declared and not estimated: a dozen poles describe an error
/// of 1 % beside little noise with fewer numbers than a random process of unknown size (rates: assumption_rates.md).
/// @param noise  of the data
[[nodiscard]] inline double smooth_error_beside(double noise) {
  constexpr double usual_smooth_error = 0.01, over_noise = 10;
  return std::min(usual_smooth_error, over_noise * noise);
}

/// Evidence (twice the logarithm of odds) that has to speak against an assumption that nobody has confirmed, odds of a
/// million to one beforehand.  An unstable system cannot be measured without a loop around it, so that those who
/// measure one know; and a smooth error, which no stable system makes, may save an unstable model some parameters.
inline constexpr double price_of_assumption = 27.6;
/// The same for a dead time, odds of ten to one.
inline constexpr double price_of_dead_time = 4.6;

/// What a model leaves of the data.
struct Leftover {
  double rms;          // of the data
  double correlation;  // of neighbours
  double price;        // of its parameters by Schwarz's criterion
};

/// Variance of the data that a rival leaves beside a smooth error of usual size.
[[nodiscard]] inline double variance_beside(const Leftover& rival) {
  return rival.rms * rival.rms + std::pow(smooth_error_beside(rival.rms), 2);
}
/// What share of that variance the residuals of a model have.
[[nodiscard]] inline double share_of_noise(const Leftover& held, const Leftover& rival) {
  return held.rms * held.rms / variance_beside(rival);
}

/// Evidence (twice the logarithm of odds) against a model that is taken to be the truth, by a rival that is not.  What
/// the truth leaves is noise, of the size of what the rival leaves, and a smooth error of usual size; the more it
/// leaves beyond the noise, the less likely that is, at each of the points that its correlation leaves independent.  A
/// model that needs more parameters than the rival, such as poles and zeros that approximate one of the rival's, pays
/// for them.
/// @param residuals  count
[[nodiscard]] inline double evidence_against(const Leftover& held, const Leftover& rival, std::size_t residuals) {
  const double beyond = (held.rms * held.rms - rival.rms * rival.rms) / variance_beside(rival);
  return static_cast<double>(residuals) * independent_share(held.correlation) * beyond + held.price - rival.price;
}

}  // namespace frac::detail
