// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace frac::detail {

/// Ceres, to the minimum within the bounds.  Its steps are those of free variables, cut off at the bounds: where one
/// presses on its bound the others come to rest early.  So those that press are held and the rest is solved again,
/// until none begins or ceases to press.
void solve_within_bounds(const ceres::Solver::Options& options, ceres::Problem& problem,
                         ceres::Solver::Summary& summary);

}  // namespace frac::detail
