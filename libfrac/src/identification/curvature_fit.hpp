#pragma once

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// fit() with intervals from the curvature alone, for refits of which nobody sees the intervals.
[[nodiscard]] FitResult curvature_fit(const FrequencyResponseData& data, const Structure& structure,
                                      const FitOptions& options);

}  // namespace frac::detail
