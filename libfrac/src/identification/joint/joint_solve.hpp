// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "joint_problem.hpp"

namespace frac::detail {

/// Values of all variables, and what they cost.
struct JointPoint {
  std::vector<double> shared;
  std::vector<std::vector<double>> own;  // of each curve
  double cost = 0;                       // what was made least: sum of squares, or of the loss, and what priors add
  bool converged = false;
};

/// Cost of the data at a point: sums of squares and of the loss.
struct JointCost {
  double squares, loss;
};
[[nodiscard]] JointCost cost_of_data(std::vector<CurveResiduals>& curves, const JointPoint& point);

/// Bounded Levenberg-Marquardt (Ceres) over all curves.  In each step the own variables are eliminated curve by curve
/// (Schur complement), so that it takes a time in proportion to the number of curves.
/// @param cost_tolerance  relative change of the cost at which to stop
[[nodiscard]] JointPoint joint_solve(std::vector<CurveResiduals>& curves, const JointLayout& layout, JointPoint start,
                                     double cost_tolerance);

}  // namespace frac::detail
