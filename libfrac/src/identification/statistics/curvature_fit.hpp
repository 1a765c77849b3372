// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "identification/data/fit_data.hpp"

namespace frac::detail {

/// fit() of a response with intervals from the curvature alone.
/// @param as_assumed  of a stable system, unless the data speak against it, and no worse than structures it contains
[[nodiscard]] FitResult response_fit_without_profiles(const FrequencyResponseData& data, const Structure& structure,
                                                      const FitOptions& options, bool as_assumed);

/// fit() with intervals from the curvature alone, as they are over time always, for refits of which nobody sees the
/// intervals.
template <class Data>
[[nodiscard]] FitResult curvature_fit(const Data& data, const Structure& structure, const OptionsOf<Data>& options) {
  if constexpr (is_response<Data>)
    return response_fit_without_profiles(data, structure, options, false);
  else
    return fit(data, structure, options);
}

/// fit() in every respect but its intervals, which are from the curvature alone.
template <class Data>
[[nodiscard]] FitResult unprofiled_fit(const Data& data, const Structure& structure, const OptionsOf<Data>& options) {
  if constexpr (is_response<Data>)
    return response_fit_without_profiles(data, structure, options, true);
  else
    return fit(data, structure, options);
}

/// Relative change of the cost at which a refit ends: residuals to a part in 1e4 of their size.
inline constexpr double settled_refit = 1e-8;

/// curvature_fit() for the sake of its residuals: what the fitted component is blind to stays where it starts.
[[nodiscard]] FitResult refit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options);
[[nodiscard]] FitResult refit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options);

/// Cost, as in FitResult, at which a quick local solve over time ends: some iterations of simulations good to 1e-6.
/// Infinite where the start has no finite response.
/// @param options  every free parameter has a start
[[nodiscard]] double scouted_cost(const TimeResponseData& data, const Structure& structure,
                                  const TimeFitOptions& options);

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
