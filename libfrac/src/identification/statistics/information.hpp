// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>
#include <span>

#include "frac/identification/statistics.hpp"

namespace frac::detail {

/// Goodness of fit of a residual vector left by a model with that many parameters the residuals can tell apart.
struct Information {
  double cost;  // sum of squares
  double rms;
  double max_residual;
  double aicc, bic;  // information_criteria()
};

/// @param parameters  not always whole: priors tell a share of some
/// @param unit        root mean square of the weighted data; residuals below 1e-14 of it are rounding.
[[nodiscard]] Information information(std::span<const double> residual, double parameters, double unit);
/// information_criteria() with any number of parameters.
[[nodiscard]] InformationCriteria criteria_of(double cost, double residuals, double parameters, double rounding_cost);

/// What n ln(cost/n) is for normal noise, for noise of Student's distribution with four degrees of freedom at the scale
/// that suits the residuals best: -2 ln of the likelihood less n (1 + ln 2 pi).  Below the normal one where few large
/// residuals, such as outliers left in or coarse rounding, make up the cost.
[[nodiscard]] double heavy_tailed_misfit(std::span<const double> residual);

/// What k parameters cost among n residuals when many counts of them were tried: k n ln n/(n - k - 2), Schwarz's k ln n
/// with the correction for few residuals (McQuarrie 1999), without which parameters in number near that of the
/// residuals buy their noise.  Infinite where n <= k + 2.
[[nodiscard]] inline double price_of_parameters(double parameters, double residuals) {
  const double rest = residuals - parameters - 2;
  return rest > 0 ? parameters * residuals * std::log(residuals) / rest : std::numeric_limits<double>::infinity();
}

}  // namespace frac::detail
