// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/lack_of_fit.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/identification/time_fit.hpp"
#include "frac/identification/uncertainty.hpp"

namespace fracfit {

/// What was asked for beyond the fit itself.
struct StatisticsRequest {
  bool profile = false;
  std::size_t bootstrap_samples = 0;  // 0: none
  /// Where the parameters of each refit go as they come; empty: nowhere.  What an interrupted run has left in
  /// FILE.partial is not computed again.
  std::string refits_file = {};
  std::string command = {};  ///< command line, for the head of that file
};

/// What the library says of a fit beside its parameters.  Lists have one entry per parameter.
struct FitStatistics {
  std::vector<std::vector<double>> correlation;  // of the estimates; NaN beside one without standard error
  std::vector<double> outlier_at;                // rad/s or s, in the order of FitResult::outliers
  frac::ResidualWhiteness whiteness;             // NaN where the model is not finite
  frac::LackOfFit lack_of_fit{};                 // not adequate where the model is not finite
  /// Empty when not asked for; unset for a parameter that has none: fixed, unseen by the fitted component, or no degree
  /// of freedom left.
  std::vector<std::optional<frac::ProfileInterval>> profile;
  std::vector<frac::BootstrapInterval> bootstrap;  // empty when not asked for
  std::size_t bootstrap_samples = 0;
  std::vector<frac::DerivedEstimate> derived;  // empty when not asked for
  std::optional<frac::Growth> growth;          // the structures tried, where the structure was grown
};

/// @param options  of the fit, with the constraints of the fitted structure
[[nodiscard]] FitStatistics fit_statistics(const frac::FrequencyResponseData& data, const frac::FitOptions& options,
                                           const frac::FitResult& result, const StatisticsRequest& request,
                                           int threads);
[[nodiscard]] FitStatistics fit_statistics(const frac::TimeResponseData& data, const frac::TimeFitOptions& options,
                                           const frac::FitResult& result, const StatisticsRequest& request,
                                           int threads);

}  // namespace fracfit
