// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/model/frequency_response_data.hpp"
#include "judgement.hpp"

namespace frac::detail {

/// The points without their dead time, and the judgement of them.
struct Timely {
  FrequencyResponseData data;
  Judgement judgement;
  double dead_time = 0;
};

/// Judges the points, and without a dead time where that explains them better.
[[nodiscard]] Timely judge_timely(const FrequencyResponseData& data, const ValidationOptions& options);

}  // namespace frac::detail
