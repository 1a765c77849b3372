// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace frac::detail {

// Decompositions of Eigen that cost ten seconds of compiler time each: compiled in one file.

/// Of a real matrix; a pair of conjugate ones stands side by side, the upper first.
[[nodiscard]] Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& matrix);

/// c (s - matrix)^-1 b as the sum of residue/(s - pole), for a matrix with as many eigenvectors as rows; pairs as
/// above.
struct PartialFractions {
  Eigen::VectorXcd poles, residues;
};
[[nodiscard]] PartialFractions partial_fractions(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& b,
                                                 const Eigen::RowVectorXd& c);

}  // namespace frac::detail
