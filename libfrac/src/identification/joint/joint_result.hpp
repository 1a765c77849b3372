// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "joint_confidence.hpp"
#include "laws.hpp"

namespace frac::detail {

/// A joint fit once it is solved.
struct JointSolution {
  const Structure& structure;
  const JointLayout& layout;
  const Laws& laws;
  const JointPoint& point;
  const JointConfidence& found;
  const std::vector<std::optional<FitResult>>& alone;  // the fit of each curve by itself
};

/// Writes the estimates, their intervals and what they leave into a result that knows its model, its counts and the
/// names of its curves.
void describe(const JointSolution& solution, std::vector<CurveResiduals>& curves, JointFitResult& result);

/// The same where no search found a finite cost.
void describe_failure(double cost, JointFitResult& result);

}  // namespace frac::detail
