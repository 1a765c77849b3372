// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac {

/// t with P(|T| <= t) = 0.95 for Student's T: half the width of a 95 % interval in standard errors; NaN for
/// degrees_of_freedom < 1.
[[nodiscard]] double student_t_95(double degrees_of_freedom);

/// What a cost (sum of squared residuals) is worth, given how many parameters were fitted; lower is better.
struct InformationCriteria {
  /// n ln(cost/n) + 2 k + 2 k (k + 1)/(n - k - 1) with k = parameters + 1, the variance being estimated too (Hurvich,
  /// Tsai 1989); infinity when n <= k + 1.
  double aicc;
  double bic;  // n ln(cost/n) + k ln n (Schwarz 1978)
};

/// @param rounding_cost  costs below it are rounding and count as it, so that the number of parameters decides among
///     exact fits
[[nodiscard]] InformationCriteria information_criteria(double cost, std::size_t residuals, std::size_t parameters,
                                                       double rounding_cost);

}  // namespace frac
