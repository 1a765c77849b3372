// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/model/frequency_response_data.hpp"

namespace frac::detail {

/// The response ahead of the data by so much: value * exp(j omega seconds).
[[nodiscard]] FrequencyResponseData without_dead_time(const FrequencyResponseData& data, double seconds);

/// The dead time without which a sum of real poles follows the points best, s.  Where points are so far apart that the
/// phase turns by more than half a cycle between them, no finite sum of poles follows it.
/// @param share  what a model without dead time leaves, root mean square of each part as share of the response
/// @return 0 unless about as little or less is left, and much less than at none
[[nodiscard]] double dead_time_of(const FrequencyResponseData& data, double share);

}  // namespace frac::detail
