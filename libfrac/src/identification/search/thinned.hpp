// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>

#include "frac/model/frequency_response_data.hpp"
#include "identification/data/residual_rule.hpp"

namespace frac::detail {

/// Points of the data with their weights.
struct Thinned {
  FrequencyResponseData data;
  ResidualRule rule;
};

/// At most `count` points, the ends among them: half of them spread evenly, half by the length of the curve in
/// logarithms, so that a resonance keeps its points.
[[nodiscard]] Thinned thinned(const FrequencyResponseData& data, const ResidualRule& rule, std::size_t count);

/// Weighted means of the data over at most `count` bins of equal width in ln omega, at their weighted mean frequencies.
/// For a model that is constant over each bin they are sufficient: the sum of squares of all points is that of the
/// means plus a part that no model changes.  Of a model that changes by d over a bin, what a point tells of the slope
/// within the bin is lost, a share d^2/12 of its information, and the mean is off by a 24th of the second difference.
/// None of residuals that are no differences of model and data, whose means are not residuals of means.
[[nodiscard]] std::optional<Thinned> binned(const FrequencyResponseData& data, const ResidualRule& rule,
                                            std::size_t count);

}  // namespace frac::detail
