// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

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

}  // namespace frac::detail
