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

}  // namespace frac::detail
