// SPDX-License-Identifier: BSD-3-Clause
#include "base/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace frac::detail {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

}  // namespace frac::detail
