// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace frac::detail {

/// The x >= 0 of least x' H x/2 - b' x for a positive definite H, by block principal pivoting (Portugal, Judice,
/// Vicente 1994).
/// @param free  which are positive: a guess on entry, the answer on exit
[[nodiscard]] Eigen::VectorXd nonnegative_minimum(const Eigen::MatrixXd& hessian, const Eigen::VectorXd& b,
                                                  std::vector<bool>& free);

/// The x >= 0 of least |A x - b| for columns of length 1, which may depend on each other, by active sets (Lawson,
/// Hanson 1974, chapter 23): no Hessian squares their condition.
[[nodiscard]] Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& b);

}  // namespace frac::detail
