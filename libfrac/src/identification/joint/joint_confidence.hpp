// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "joint_solve.hpp"

namespace frac::detail {

/// Errors of variables that the curvature at a minimum tells.  NaN at a bound or where the residuals do not see one.
struct JointConfidence {
  Eigen::MatrixXd shared;              // covariance of the shared variables
  std::vector<Eigen::MatrixXd> curve;  // covariance of the own variables of each curve, then of the shared ones
  std::vector<bool> shared_at_bound;
  std::vector<std::vector<bool>> own_at_bound;
  std::vector<double> shared_widening;  // factor of the errors by the correlation of neighbouring residuals
  std::vector<std::vector<double>> own_widening;
  std::size_t rank;              // variables that the residuals can tell, and those at a bound
  double from_priors;            // how many of these priors tell in place of the residuals
  double deviation;              // of a residual in units of the noise it was taken to have
  double loss_unit;              // as in FitResult, in these units: the square of the deviation where there is no loss
  double condition;              // of the scaled Fisher matrix of the shared variables
  double half_width;             // of a 95 % interval in standard errors
  double noise_correlation = 0;  // of neighbours, the mean over the curves
};

[[nodiscard]] JointConfidence joint_confidence(std::vector<CurveResiduals>& curves, const JointLayout& layout,
                                               const JointPoint& point);

}  // namespace frac::detail
