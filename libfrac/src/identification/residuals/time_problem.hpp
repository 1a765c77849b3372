// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/time_fit.hpp"
#include "problem.hpp"
#include "time_residuals.hpp"

namespace frac::detail {

/// Simulations of the final solve, at rounding.
inline constexpr double finest_simulation = 1e-13;

/// A fit of a structure to samples of input and output.  A dead time is bounded by the length of the record, beyond
/// which nothing would be left to fit.
class TimeProblem final : public Problem {
 public:
  /// @throws std::invalid_argument  constraints that do not go with the structure, as fit() says.
  TimeProblem(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options);
  /// The problem by the parameters themselves; constraints are left aside.
  TimeProblem(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options, ByParameters);

  const TimeResponseData& data;
  const TimeFitOptions options;

  [[nodiscard]] TimeResiduals& residuals() override;
  /// Residuals of the outputs of these indices.
  /// @param tolerance  of the simulation
  [[nodiscard]] TimeResiduals residuals_at(std::vector<std::size_t> index, double tolerance) const;
  /// Null but under Hold::band_limited.
  [[nodiscard]] const std::shared_ptr<const PeriodicInput>& periodic() const noexcept { return periodic_; }
  /// A parameter of the structure, or the offset.
  [[nodiscard]] std::unique_ptr<Problem> held(std::string_view parameter, double value) const override;
  /// This problem with the output at rest known.
  [[nodiscard]] std::unique_ptr<TimeProblem> with_offset(double offset) const;

 private:
  TimeProblem(const TimeProblem& like, TimeFitOptions known, std::vector<ParameterConstraint> of_parameters);

  std::shared_ptr<const PeriodicInput> periodic_;
  std::optional<TimeResiduals> residuals_;
};

/// Standard deviation of the weighted output, about its mean or an offset: the unit of the residuals that solvers see.
[[nodiscard]] double output_deviation(const TimeResponseData& data, std::optional<double> offset);

/// s, from the first sample to the last.
[[nodiscard]] double length_of(const TimeResponseData& data);

}  // namespace frac::detail
