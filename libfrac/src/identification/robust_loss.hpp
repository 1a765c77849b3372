#pragma once

#include <vector>

#include "local_solve.hpp"

namespace frac::detail {

/// 1.4826 times the median absolute residual: the standard deviation of the well-behaved part (normal residuals).
[[nodiscard]] double robust_spread(std::vector<double> residual);

/// The loss in units of the spread of the residuals at theta.
[[nodiscard]] LocalOptions robust_options(const Residuals& residuals, const std::vector<double>& theta, Loss loss);

/// Refines a least-squares solution under a robust loss whose scale follows the residuals until it settles.
LocalOptions robust_refinement(const Residuals& residuals, Loss loss, LocalSolution& solution);

}  // namespace frac::detail
