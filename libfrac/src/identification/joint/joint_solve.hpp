// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "joint_problem.hpp"

namespace frac::detail {

/// Values of all variables, and what they cost.
struct JointPoint {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;  // of each curve
  double cost = 0;                       // sum of squares
  bool converged = false;
};

/// Bounded Levenberg-Marquardt (Ceres) over all curves.  In each step the own variables are eliminated curve by curve
/// (Schur complement), so that it takes a time in proportion to the number of curves.
/// @param cost_tolerance  relative change of the cost at which to stop
[[nodiscard]] JointPoint joint_solve(std::vector<CurveResiduals>& curves, const JointLayout& layout, JointPoint start,
                                     double cost_tolerance);

}  // namespace frac::detail
