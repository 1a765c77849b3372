// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// A ranked candidate with what a verdict needs beside.
struct Competitor {
  RankedFit ranked;
  std::vector<double> residual;  // weighted
};

/// Fills in the verdict of a ranking as IdentificationResult defines it.
/// @param competitors  in the order of the ranking
/// @param rival_skipped  whether a candidate of integer order could not be fitted
void judge(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
           const std::vector<Competitor>& competitors, bool rival_skipped);
void judge(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
           const std::vector<Competitor>& competitors, bool rival_skipped);

}  // namespace frac::detail
