// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

namespace frac::detail {

/// Variance of the residuals of a curve, as a fit of this curve alone tells it.
struct CurveVariance {
  double variance;  // of a residual
  double degrees;   // of freedom it was estimated with; 0: not estimated
};

/// Variances drawn towards a common level by as much as their spread says that they are estimates of it (Smyth 2004,
/// moderated variances): all alike where they differ no more than chance makes them, and as estimated where they differ
/// by far more.  A curve whose variance is not estimated gets the common level; 1 where none is.
[[nodiscard]] std::vector<double> moderated_variances(std::span<const CurveVariance> estimated);
/// Their square roots.
[[nodiscard]] std::vector<double> moderated_deviations(std::span<const CurveVariance> estimated);

}  // namespace frac::detail
