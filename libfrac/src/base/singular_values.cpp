// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/SVD>

#include "base/linear_algebra.hpp"

namespace frac::detail {

RightSingularVectors right_singular_vectors(const Eigen::MatrixXd& matrix) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinV);
  return {svd.singularValues(), svd.matrixV()};
}

}  // namespace frac::detail
