// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem.hpp"

namespace frac::detail {

/// A fit of a structure to a frequency response.
class FrequencyProblem final : public Problem {
 public:
  /// @throws std::invalid_argument  constraints or a weight that do not go with structure or data, as fit() says.
  FrequencyProblem(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options);
  /// The problem by the parameters themselves; constraints are left aside.
  FrequencyProblem(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                   ByParameters);

  const FrequencyResponseData& data;
  const FitOptions options;
  const ResidualRule rule;

  [[nodiscard]] Residuals& residuals() override { return residuals_; }
  [[nodiscard]] std::unique_ptr<Problem> held(std::string_view parameter, double value) const override;

 private:
  FrequencyProblem(const FrequencyProblem& like, std::vector<ParameterConstraint> known);

  FrequencyResiduals residuals_;
};

}  // namespace frac::detail
