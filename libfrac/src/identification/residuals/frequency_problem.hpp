// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "residuals.hpp"

namespace frac::detail {

/// Typical magnitudes of the data and the ranges they span.
[[nodiscard]] DataScale data_scale(const FrequencyResponseData& data);

/// What a fit of a structure to a frequency response minimises.
struct FrequencyProblem {
  /// @throws std::invalid_argument  constraints or a weight that do not go with structure or data, as fit() says.
  FrequencyProblem(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options);
  FrequencyProblem(const FrequencyProblem&) = delete;
  FrequencyProblem& operator=(const FrequencyProblem&) = delete;

  const FrequencyResponseData& data;
  const Structure& structure;
  const FitOptions& options;
  ParameterMap map;
  Priors priors;
  ResidualRule rule;
  FrequencyResiduals residuals;
};

}  // namespace frac::detail
