// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac::detail {

/// fit() with intervals from the curvature alone, for refits of which nobody sees the intervals.
[[nodiscard]] FitResult curvature_fit(const FrequencyResponseData& data, const Structure& structure,
                                      const FitOptions& options);
/// Over time intervals are from the curvature always.
[[nodiscard]] inline FitResult curvature_fit(const TimeResponseData& data, const Structure& structure,
                                             const TimeFitOptions& options) {
  return fit(data, structure, options);
}

/// fit() in every respect but its intervals, which are from the curvature alone.
[[nodiscard]] FitResult unprofiled_fit(const FrequencyResponseData& data, const Structure& structure,
                                       const FitOptions& options);
[[nodiscard]] inline FitResult unprofiled_fit(const TimeResponseData& data, const Structure& structure,
                                              const TimeFitOptions& options) {
  return fit(data, structure, options);
}

/// Relative change of the cost at which a refit ends: residuals to a part in 1e4 of their size.
inline constexpr double settled_refit = 1e-8;

/// curvature_fit() for the sake of its residuals: what the fitted component is blind to stays where it starts.
[[nodiscard]] FitResult refit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options);
[[nodiscard]] FitResult refit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options);

/// Parameters whose wide intervals follow the cost.
enum class Profiled { all, orders };

/// fit() of one candidate among others: above a cost that another beats by far, the search ends early and intervals are
/// from the curvature.
[[nodiscard]] FitResult fit_in_reach(const FrequencyResponseData& data, const Structure& structure,
                                     const FitOptions& options, double hopeless, Profiled profiled);
/// Over time intervals are from the curvature always.
[[nodiscard]] FitResult fit_in_reach(const TimeResponseData& data, const Structure& structure,
                                     const TimeFitOptions& options, double hopeless, Profiled profiled);

}  // namespace frac::detail
