// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/model/frequency_response_data.hpp"

namespace frac::detail {

/// The response ahead of the data by so much: value * exp(j omega seconds).
[[nodiscard]] FrequencyResponseData without_dead_time(const FrequencyResponseData& data, double seconds);

struct DeadTime {
  double seconds;
  double left;  // root mean square of each part, in units of hypot(|value|, floor)
};

/// Dead times without which a sum of poles at fixed places follows the points better than those next to them and much
/// better than without any, the best first.  Where points are so far apart that the phase turns by more than half a
/// cycle between them, no finite sum of poles follows it.
/// @param floor  additive part of the noise where the relative part is 1, in the unit of the values
[[nodiscard]] std::vector<DeadTime> dead_times_of(const FrequencyResponseData& data, double floor);

}  // namespace frac::detail
