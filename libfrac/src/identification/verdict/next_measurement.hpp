// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// The half decade, within the band or a decade beyond, in which fewest points of the accuracy so far would change the
/// evidence between two fits by `wanted`; where 64 are not enough, the best half decade with 64 of better accuracy.
///
/// Evidence changes by the squared difference of the two responses over the variance of noise and of what the fits do
/// not know yet: by what the wrong one cannot take back by adapting itself.
/// @param noise  standard deviation of a weighted residual
/// Empty for components and weights without a residual of the model alone, realisations other than the exact one, and
/// fits that are alike everywhere.
[[nodiscard]] std::optional<NextMeasurement> next_measurement(const FrequencyResponseData& data,
                                                              const FitOptions& options, const FitResult& a,
                                                              const FitResult& b, double noise, double wanted);

}  // namespace frac::detail
