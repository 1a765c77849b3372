// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace frac::detail {

/// Options that all solves have in common.  They stop by relative changes of cost and variables alone, since residuals
/// are scaled, and print nothing.  A step that a bound cuts short is judged like any other, because a search along it
/// costs more than the next step.  Sums are formed by one thread, in one order, so that results do not depend on
/// threads.
[[nodiscard]] ceres::Solver::Options solver_options(int iterations, double cost_tolerance);

/// Ceres, to the minimum within the bounds.  Its steps are those of free variables, cut off at the bounds: where one
/// presses on its bound the others come to rest early.  So those that press are held and the rest is solved again,
/// until none begins or ceases to press.
void solve_within_bounds(const ceres::Solver::Options& options, ceres::Problem& problem,
                         ceres::Solver::Summary& summary);

}  // namespace frac::detail
