// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "correlated_noise.hpp"
#include "identification/residuals/problem.hpp"
#include "identification/search/local_solve.hpp"

namespace frac::detail {

/// Beyond this condition of the scaled Fisher matrix the estimates along a flat direction are noise, whatever the
/// residuals.
inline constexpr double flat_condition = 1e6;

/// A column of the Jacobian this much smaller than the largest is rounding: the residuals do not see the variable.
inline constexpr double unseen_column = 1e-10;

/// Whether a variable of the search stands at one of its limits.
[[nodiscard]] bool is_at_bound(double value, double lower, double upper);

/// What the curvature at a minimum says about each parameter of the user.  Standard errors are those in white noise;
/// `widening` tells how much more the noise that the residuals show allows for.
struct Confidence {
  std::vector<double> standard_error;           // NaN: fixed, at a bound, or not seen
  std::vector<double> centre_standard_error;    // of the parameter with frequency in units of the middle of the band
  std::vector<std::vector<double>> covariance;  // in the noise that the residuals show
  std::vector<bool> at_bound;
  std::vector<bool> seen;        // the residuals depend on it
  std::vector<bool> identified;  // seen, interval within 50 %, not part of a flat direction
  std::size_t rank;              // of the scaled Jacobian: parameters the residuals and priors can tell apart
  double condition;              // of the scaled Fisher matrix
  double t;                      // half width of a 95 % interval in standard errors
  double deviation;              // standard deviation of a residual, NaN without a degree of freedom
  double loss_unit;       // see FitResult, in units of the residuals: rise of the objective for one standard error
  CorrelatedNoise noise;  // of the residuals
  std::vector<double> widening;  // of each standard error, by the correlation of neighbouring residuals
  /// count() x known ones: changes of the residuals, orthonormal but for what priors tell; 0 where there are none.
  Eigen::MatrixXd directions;
  Eigen::MatrixXd spread;  // parameters x known ones: what an estimate moves by along each; empty if unknown
  double from_priors = 0;  // how many parameters priors tell in place of the residuals

  /// Parameters that the residuals tell.
  [[nodiscard]] double effective() const { return static_cast<double>(rank) - from_priors; }
};

[[nodiscard]] Confidence confidence(const Residuals& residuals, const LocalSolution& solution,
                                    const LocalOptions& options);

/// The same where priors weigh against the residuals by the noise that these tell: the solution moves until that stays.
[[nodiscard]] Confidence weighed_confidence(Problem& problem, LocalSolution& solution, const LocalOptions& options);

}  // namespace frac::detail
