// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <span>

namespace frac::detail {

/// The residual that least squares leaves of white noise: residual = (I - Q Q') noise.  Rows 2 k and 2 k + 1 are real
/// and imaginary part of point k.
struct ProjectedResidual {
  Eigen::MatrixXd orthonormal;  // Q, of the tangent of the model at its optimum
  Eigen::VectorXd residual;

  [[nodiscard]] double freedom() const { return static_cast<double>(residual.size() - orthonormal.cols()); }
  [[nodiscard]] double square() const { return residual.squaredNorm(); }
};

struct CorrelationTest {
  double excess;   // of sum w_l e_k e_(k+l) / sum e_k^2 over what white noise leaves on average
  double p_value;  // chance of at least that
};

/// Whether residuals of points at distances 1, 2 ... follow each other, with these weights.  Mean, variance and
/// skewness of the quotient in white noise are exact (Durbin, Watson 1950; their bounds are not needed, since Q is
/// known); the tail is that of the gamma distribution with these moments.
[[nodiscard]] CorrelationTest correlation_test(const ProjectedResidual& of, std::span<const double> weights);

/// Coefficient of one more column of the model.
struct AddedColumn {
  double coefficient, deviation;
  double p_value;  // chance of a coefficient as large of either sign
};
[[nodiscard]] AddedColumn added_column(const ProjectedResidual& of, const Eigen::VectorXd& column);

/// The column with the largest t-value, out of columns of which neighbours are alike: places of a step, say.
struct LargestColumn {
  Eigen::Index which;  // below 0: no column differs from what the model can follow
  AddedColumn column;  // p_value: chance that any of the columns shows as much
};
/// The chance is bounded by that of the first column and of each further one without the one before it (Worsley 1982).
/// The bound is sharp where neighbouring columns are alike; multiplying by their number would be far too careful.
[[nodiscard]] LargestColumn largest_column(const ProjectedResidual& of, const Eigen::MatrixXd& columns);

/// The residual when the column is added.
[[nodiscard]] ProjectedResidual with_column(const ProjectedResidual& of, const Eigen::VectorXd& column);

/// Chance that noise alone makes the residuals of these points as large beside the others.
[[nodiscard]] double excess_chance(const ProjectedResidual& of, std::span<const Eigen::Index> points);

/// Mean share of its own noise that the model takes from a point, 0 to 1.
[[nodiscard]] inline double leverage(const ProjectedResidual& of, Eigen::Index point) {
  return of.orthonormal.middleRows(2 * point, 2).squaredNorm() / 2;
}

}  // namespace frac::detail
