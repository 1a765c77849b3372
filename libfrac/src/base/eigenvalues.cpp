// SPDX-License-Identifier: BSD-3-Clause
#include "base/eigenvalues.hpp"

#include <Eigen/Eigenvalues>

namespace frac::detail {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(matrix, false).eigenvalues();
}

Eigensystem eigensystem(const Eigen::MatrixXd& matrix) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace frac::detail
