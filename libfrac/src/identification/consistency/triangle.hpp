// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace frac::detail {

/// Least squares of a target by the first few of some columns, for every number of them: R of Q R = (columns, target).
/// Complex columns and target are fitted by real coefficients, so that each row counts as two.
class Triangle {
 public:
  /// @param target  real and imaginary part of each row in turn
  Triangle(const Eigen::MatrixXcd& columns, const Eigen::VectorXd& target);

  /// Squared distance of the target from the space of the first `columns` columns.
  [[nodiscard]] double squared_distance(Eigen::Index columns) const;
  /// Coefficients of the first `columns` columns; not finite where these depend on each other exactly.
  [[nodiscard]] Eigen::VectorXd solution(Eigen::Index columns) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> entries_;
};

}  // namespace frac::detail
