// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "joint_problem.hpp"
#include "joint_solve.hpp"
#include "laws.hpp"
#include "preparation.hpp"

namespace frac::detail {

/// Takes constraints on parameters of the laws, which the fits of single curves do not know, out of a list.
/// @throws std::invalid_argument  one of them is fixed
[[nodiscard]] std::vector<ParameterConstraint> taken_out(std::vector<ParameterConstraint>& constraints,
                                                         const Laws& laws);

/// Limits of parameters that a law drives are those of the law.
void free_driven(std::vector<ParameterConstraint>& constraints, const Structure& structure, const Laws& laws);

/// Start values that the user gives parameters of the laws; NaN where none.
[[nodiscard]] std::vector<double> given_starts(const Laws& laws, const std::vector<ParameterConstraint>& constraints);

/// The variables that stand for the parameters of the laws.
/// @param starts  set to where they start
[[nodiscard]] std::vector<JointVariable> variables_of(const Laws& laws,
                                                      const std::vector<ParameterConstraint>& constraints,
                                                      const StartValues& values, std::vector<double>& starts);

/// A search of all variables from what is known before: of the problem, its laws, and where it ended.
class JointSearch {
 public:
  JointSearch(const std::vector<JointCurve>& curves, const Structure& structure, JointFitOptions options,
              const Preparation& known, const Laws& laws);
  JointSearch(const JointSearch&) = delete;
  JointSearch& operator=(const JointSearch&) = delete;

  /// @throws std::invalid_argument  there are more free parameters than residuals
  void run(const JointFitOptions& options, const Preparation& known, JointFitResult& result);

  [[nodiscard]] std::vector<double> parameters(std::size_t curve) const {
    return layout_->parameters(point.shared, point.own[curve], curve);
  }
  [[nodiscard]] const JointLayout& layout() const { return *layout_; }
  [[nodiscard]] std::vector<CurveResiduals>& problem() { return problem_; }

  JointPoint point;
  std::vector<double> noise;          // that the search left, where it is not given
  double squares_at_known_noise = 0;  // cost with the noise it began with
  /// Twice the negative logarithm of the likelihood, up to a constant.  Costs do not compare two ends that leave
  /// different noise, since a curve in a wrong place then passes for a noisy one.
  double unlikelihood = 0;

 private:
  std::optional<JointLayout> layout_;
  std::vector<CurveResiduals> problem_;
  std::vector<std::vector<double>> shared_, own_;
};

}  // namespace frac::detail
