// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace frac::detail {

/// Q R P' = columns by Gram and Schmidt, the longest remaining column first, beside a vector and what of it lies in the
/// space of the columns.  For tall matrices of few columns, of which it takes a third of the time of PivotedQr and its
/// basis.
struct Orthonormalised {
  Eigen::MatrixXd basis;            // Q: as many columns as the rank
  Eigen::MatrixXd triangle;         // R, upper
  std::vector<Eigen::Index> order;  // P: of the columns in the basis
  Eigen::VectorXd share;            // of the vector, along the basis
  Eigen::VectorXd rest;             // of the vector

  /// Least-squares solution for the vector; zero for columns beyond the rank.
  [[nodiscard]] Eigen::VectorXd solution() const;
};

/// @param columns    finite
/// @param threshold  remaining columns below this share of the longest one count as zero
[[nodiscard]] Orthonormalised orthonormalised(Eigen::MatrixXd columns, const Eigen::VectorXd& vector, double threshold);

/// columns' columns, of few columns: Eigen's product is made for large matrices.
[[nodiscard]] Eigen::MatrixXd products_of(const Eigen::MatrixXd& columns);

/// Takes from the columns what lies in the space of an orthonormal basis.
void remove_span(const Eigen::MatrixXd& basis, Eigen::Ref<Eigen::MatrixXd> columns);

}  // namespace frac::detail
