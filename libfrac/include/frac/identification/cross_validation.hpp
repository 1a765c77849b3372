// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frac/identification/model_choice.hpp"

namespace frac {

/// How well each candidate of a ranking predicts what it was not fitted to.
struct CandidatePredictions {
  /// As cross_validation(), in the order of the ranking; of a fixed curve, which nothing was fitted to, its own rms;
  /// NaN where too few points are left for a fit.
  std::vector<double> rms;
  std::vector<std::string> notes;  // why there is none of a candidate, a sentence each
};

/// @param options  those of the ranking
/// @throws std::invalid_argument  folds < 2 or more than points.
[[nodiscard]] CandidatePredictions cross_validations(const FrequencyResponseData& data, const FitOptions& options,
                                                     const IdentificationResult& ranking, std::size_t folds,
                                                     int threads = 0);
[[nodiscard]] CandidatePredictions cross_validations(const TimeResponseData& data, const TimeFitOptions& options,
                                                     const IdentificationResult& ranking, std::size_t folds,
                                                     int threads = 0);

}  // namespace frac
