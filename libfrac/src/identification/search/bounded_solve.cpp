// SPDX-License-Identifier: BSD-3-Clause
#include "bounded_solve.hpp"

#include <ceres/manifold.h>

#include <cstddef>
#include <vector>

namespace frac::detail {
namespace {

using Blocks = std::vector<double*>;
/// Variables of each block at a bound beyond which the cost would fall.
using Pressing = std::vector<std::vector<int>>;

bool any_at_bound(const ceres::Problem& problem, const Blocks& blocks) {
  for (const double* block : blocks) {
    for (int k = 0; k < problem.ParameterBlockSize(block); ++k) {
      if (block[k] <= problem.GetParameterLowerBound(block, k) || block[k] >= problem.GetParameterUpperBound(block, k))
        return true;
    }
  }
  return false;
}

Pressing pressing(ceres::Problem& problem, const Blocks& blocks) {
  Pressing result(blocks.size());
  if (!any_at_bound(problem, blocks)) return result;
  ceres::Problem::EvaluateOptions all;
  all.parameter_blocks = blocks;
  std::vector<double> gradient;
  if (!problem.Evaluate(all, nullptr, nullptr, &gradient, nullptr)) return result;
  std::size_t at = 0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (int k = 0; k < problem.ParameterBlockSize(blocks[b]); ++k, ++at) {
      const double value = blocks[b][k];
      const bool below = value <= problem.GetParameterLowerBound(blocks[b], k) && gradient[at] > 0;
      const bool above = value >= problem.GetParameterUpperBound(blocks[b], k) && gradient[at] < 0;
      if (below || above) result[b].push_back(k);
    }
  }
  return result;
}

}  // namespace

ceres::Solver::Options solver_options(int iterations, double cost_tolerance) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = iterations;
  options.function_tolerance = cost_tolerance;
  options.gradient_tolerance = 1e-300;
  options.parameter_tolerance = 1e-14;
  options.max_num_consecutive_invalid_steps = 20;
  options.max_num_line_search_step_size_iterations = 0;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  return options;
}

void solve_within_bounds(const ceres::Solver::Options& options, ceres::Problem& problem,
                         ceres::Solver::Summary& summary) {
  Blocks blocks;
  problem.GetParameterBlocks(&blocks);
  Pressing held(blocks.size());
  // Undamped steps are for starts near the minimum: what is pressed against its bound there is held from the beginning.
  const bool is_near = options.initial_trust_region_radius > ceres::Solver::Options().initial_trust_region_radius;
  if (is_near && pressing(problem, blocks) != held)
    summary.termination_type = ceres::CONVERGENCE;
  else
    ceres::Solve(options, &problem, &summary);
  constexpr int most_rounds = 5;
  for (int round = 0; round < most_rounds && summary.IsSolutionUsable(); ++round) {
    Pressing next = pressing(problem, blocks);
    if (next == held) return;
    held = std::move(next);
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const int size = problem.ParameterBlockSize(blocks[b]);
      if (static_cast<int>(held[b].size()) == size)
        problem.SetParameterBlockConstant(blocks[b]);
      else if (!held[b].empty())
        problem.SetManifold(blocks[b], new ceres::SubsetManifold(size, held[b]));
    }
    ceres::Solve(options, &problem, &summary);
    for (double* const block : blocks) {
      problem.SetParameterBlockVariable(block);
      problem.SetManifold(block, nullptr);
    }
  }
}

}  // namespace frac::detail
