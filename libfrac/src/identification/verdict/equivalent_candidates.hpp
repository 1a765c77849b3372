// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Keeps one of the candidates that are the same model in several spellings, such as two arcs as a preset and as the
/// member of a family, and puts the names of the others into its RankedFit::also.  A preset goes before the member of a
/// family.
/// @param competitors  in the order of the candidates
void merge_equivalent(std::vector<Competitor>& competitors, const FrequencyResponseData& data,
                      const FitOptions& options);
void merge_equivalent(std::vector<Competitor>& competitors, const TimeResponseData& data,
                      const TimeFitOptions& options);

}  // namespace frac::detail
