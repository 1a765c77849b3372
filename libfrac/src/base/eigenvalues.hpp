// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace frac::detail {

// Eigen's solver costs ten seconds of compiler time: it is compiled in one file.

/// Eigenvalues of a real matrix; a conjugate pair stands side by side, the upper one first.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// Eigenvalues in the same order, and the right eigenvectors of length 1 as columns.
struct Eigensystem {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
[[nodiscard]] Eigensystem eigensystem(const Eigen::MatrixXd& matrix);

}  // namespace frac::detail
