// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace frac::detail {

/// Variance of a quantity of parameters, given its derivatives by them; parameters without a covariance carry nothing.
/// NaN where rounding, some units of which entries and their sum have, may be more than some per cent of it, as the
/// parameters only trade off and their huge variances cancel.
[[nodiscard]] inline double carried_variance(const std::vector<std::vector<double>>& covariance,
                                             std::span<const double> derivative) {
  constexpr double least_share = 100 * std::numeric_limits<double>::epsilon();
  double variance = 0, size = 0;
  for (std::size_t i = 0; i < derivative.size(); ++i) {
    for (std::size_t k = 0; k < derivative.size(); ++k) {
      const double product = derivative[i] * derivative[k];
      if (product == 0 || std::isnan(covariance[i][k])) continue;
      variance += product * covariance[i][k];
      size += std::abs(product * covariance[i][k]);
    }
  }
  return variance >= least_share * size ? variance : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace frac::detail
