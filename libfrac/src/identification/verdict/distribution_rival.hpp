// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// The best sum of lags whose times are spread about few centres, with a constant, s and 1/s where they pay; see
/// DistributionRival.  None of one number a point (magnitude, phase).
/// @param data, options  those of the fractional finalist
/// @param share          of the points that carry news
[[nodiscard]] std::optional<DistributionRival> distribution_rival(const FrequencyResponseData& data,
                                                                  const FitOptions& options,
                                                                  const Competitor& fractional, double share);

}  // namespace frac::detail
