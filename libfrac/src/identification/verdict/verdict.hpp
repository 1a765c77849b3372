// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "frac/identification/identify.hpp"

namespace frac::detail {

/// A ranked candidate with what a verdict needs beside.
struct Competitor {
  RankedFit ranked;
  std::vector<double> residual;  // weighted
  /// What FamilyMembers says of a member of a family.
  double departed = std::numeric_limits<double>::infinity();
  std::size_t relaxations = 0;
};

/// Fills in the verdict of a ranking as IdentificationResult defines it.
/// @param competitors  in the order of the ranking
/// @param skipped_rivals  names of the candidates of integer order that could not be fitted
void judge(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals);
void judge(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals);

}  // namespace frac::detail
