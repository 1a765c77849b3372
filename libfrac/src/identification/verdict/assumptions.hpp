// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Replaces the chosen candidate, where Assumptions take not to be what it is, by the best one of its class that keeps
/// to them, and notes what was done.  An unstable model, or one that is no passive immittance, stays where the data
/// speak for it by more than price_of_assumption for each, one with a dead time by more than price_of_dead_time.
/// @param competitors  in the order of the ranking
void keep_to_assumptions(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                         const std::vector<Competitor>& competitors);

}  // namespace frac::detail
