// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Fills in the verdict of a ranking as IdentificationResult defines it.
/// @param competitors  in the order of the ranking
/// @param skipped_rivals  names of the candidates of integer order that could not be fitted
void judge(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals);
void judge(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals);

}  // namespace frac::detail
