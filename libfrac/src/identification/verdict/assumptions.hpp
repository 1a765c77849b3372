// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Replaces the chosen candidate, where Assumptions take not to be what it is, by the one of least criterion of its
/// class that keeps to them, and notes what was done.  An unstable model, or one that is no passive immittance, stays
/// where the data speak against every stable or passive one by more than price_of_assumption for each, one with a dead
/// time where they speak for it by more than price_of_dead_time.
/// @param competitors  in the order of the ranking
void keep_to_assumptions(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                         const std::vector<Competitor>& competitors);
/// Replaces the chosen candidate, where it is a member of a family without a physical meaning, by the sum of passive
/// elements, unless the verdict speaks against its class or the data speak against it by more than price_of_assumption,
/// and notes what was done.
void prefer_elements(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                     const std::vector<Competitor>& competitors);

}  // namespace frac::detail
