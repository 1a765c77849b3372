// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "frac/model/frequency_response_data.hpp"
#include "identification/data/residual_rule.hpp"

namespace frac::detail {

/// One factor of a denominator: s/p + 1 with p = sign exp(log_size), or s^2/w^2 + 2 sinh(damping) s/w + 1 with
/// w = exp(log_size).  The hyperbolic sine lets a pair run from undamped to two distant real poles, and into the right
/// half plane, without a seam.  Sizes are in units of the middle of the band.
struct PoleFactor {
  bool pair = false;
  double log_size = 0;
  double damping = 0;  // of a pair
  double sign = 1;     // of a single pole: -1 in the right half plane
};

/// exp(-L s) (c_low s^low + ... + c_degree s^degree)/(s^integrators * factors) without its coefficients c, which follow
/// from linear least squares wherever the rest is known.
struct RationalShape {
  std::vector<PoleFactor> factors;
  std::size_t integrators = 0;
  std::size_t low = 0;
  std::size_t degree = 0;
  bool delayed = false;
  double delay = 0;  // in units of 1/(middle of the band)

  /// Poles, integrators included.
  [[nodiscard]] std::size_t order() const;
  /// Parameters that act nonlinearly.
  [[nodiscard]] std::size_t nonlinear() const { return order() - integrators + (delayed ? 1 : 0); }
};

/// A shape at its least cost.
struct RationalFit {
  RationalShape shape;
  double cost = 0;             // sum of squared residuals in the unit of the rule
  std::size_t parameters = 0;  // that the residuals can tell apart, coefficients included
};

/// Weighted least squares of rational functions by variable projection: the residuals are linear in the numerator, so
/// only poles and delay are searched for (Golub, Pereyra 1973; Jacobian of Kaufman 1975).
class RationalProblem {
 public:
  /// @param rule  of the imaginary, the real, or both parts
  RationalProblem(const FrequencyResponseData& data, const ResidualRule& rule);

  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(target_.size()); }
  /// Whether residuals are of the real or of the imaginary part alone.
  [[nodiscard]] bool one_part() const { return form_ != ResidualForm::cartesian; }
  [[nodiscard]] double centre_omega() const { return centre_; }
  [[nodiscard]] double log_lower() const { return log_lower_; }  // of the band, in units of its middle
  [[nodiscard]] double log_upper() const { return -log_lower_; }
  [[nodiscard]] const std::vector<double>& log_omega() const { return log_omega_; }
  /// Costs below it are rounding.
  [[nodiscard]] double rounding_cost() const { return 1e-28 * static_cast<double>(rows()); }

  /// Cost at the shape as it is; infinite where the model overflows.
  [[nodiscard]] RationalFit at(const RationalShape& shape) const;
  /// Levenberg-Marquardt in poles and delay from the shape.  Ceres is not used here: setting up one of its problems
  /// takes longer than one of these solves, of which a growth makes hundreds, and poles change kind on the way.
  [[nodiscard]] RationalFit refine(const RationalShape& start, int iterations) const;
  /// Size of the residual at each point.
  [[nodiscard]] std::vector<double> residual_sizes(const RationalShape& shape) const;
  /// Coefficients of s^low .. s^degree, s in rad/s, of the numerator; the shortest where some are not seen.
  [[nodiscard]] std::vector<double> numerator(const RationalShape& shape) const;

 private:
  struct Linear;
  [[nodiscard]] Eigen::MatrixXcd basis(const RationalShape& shape) const;
  void put(const Eigen::VectorXcd& values, Eigen::Ref<Eigen::VectorXd> column) const;
  bool solve(const RationalShape& shape, Linear& linear) const;
  [[nodiscard]] RationalFit levenberg_marquardt(RationalShape shape, int iterations) const;

  ResidualForm form_;
  double centre_, log_lower_;
  std::vector<double> log_omega_;
  Eigen::VectorXd weight_, target_;
  Eigen::VectorXcd s_;
};

}  // namespace frac::detail
