// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/residuals/residuals.hpp"

namespace frac::detail {

struct LocalSolution {
  std::vector<double> theta;
  double cost = 0;       // plain sum of squares and what priors add, without the loss
  double objective = 0;  // the same with the loss; the cost where there is none
  bool converged = false;
};

struct LocalOptions {
  int iterations = 200;
  double cost_tolerance = 1e-14;  // relative change of the cost at which to stop
  Loss loss = Loss::none;
  double loss_scale = 1;  // residual at which the loss turns from quadratic to robust
  /// Radius of the trust region at the start: 1/radius is the share of the curvature by which steps are damped.
  double radius = 1e4;
};

/// The costs at theta, as of a solution that has converged there; infinite where the model is not finite.
[[nodiscard]] LocalSolution solution_at(const Residuals& residuals, const std::vector<double>& theta,
                                        const LocalOptions& options);

/// Bounded Levenberg-Marquardt from a start inside the bounds at which the residuals are finite: by Ceres, or by
/// normal_solve() where the tolerance is that of a scout.
[[nodiscard]] LocalSolution local_solve(const Residuals& residuals, const std::vector<double>& start,
                                        const LocalOptions& options);

}  // namespace frac::detail
