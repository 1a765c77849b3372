// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Replaces the chosen candidate, if it is unstable, has a dead time, or is no passive immittance where Assumptions
/// take that not to be, by the best one of its class that keeps to them, unless the data speak against that one by more
/// than price_of_assumption() for each; and notes what was done.
/// @param competitors  in the order of the ranking
void keep_to_assumptions(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                         const std::vector<Competitor>& competitors);
/// Over time nothing is assumed.
inline void keep_to_assumptions(IdentificationResult&, const TimeResponseData&, const TimeFitOptions&,
                                const std::vector<Competitor>&) {}

}  // namespace frac::detail
