// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace frac::detail {

// The decompositions of Eigen behind functions that are no templates: compiled in one file, where each user would
// spend five to ten seconds on them, and a second on their headers.

/// These columns.  The name for all rows is in another namespace in Eigen 5 than in 3.4.
template <typename Matrix, typename Indices>
Eigen::MatrixXd chosen_columns(const Matrix& matrix, const Indices& columns) {
  return matrix(Eigen::seqN(0, matrix.rows()), columns);
}

/// Q R P' = columns by Householder reflections, the longest remaining column first.
class PivotedQr {
 public:
  explicit PivotedQr(const Eigen::MatrixXd& columns);
  /// @param threshold  pivots below this share of the largest count as zero
  PivotedQr(const Eigen::MatrixXd& columns, double threshold);

  [[nodiscard]] Eigen::Index rank() const;
  /// Least-squares solution; zero for the columns beyond the rank.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// Orthonormal, of the space of the columns: as many as the rank.
  [[nodiscard]] Eigen::MatrixXd basis() const;
  /// The columns, those first that are furthest from the space of the ones before.
  [[nodiscard]] std::vector<Eigen::Index> order() const;

 private:
  using Factors = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
  std::shared_ptr<const Factors> factors_;
};

/// Q R = columns by Householder reflections in the order given: three times as fast, for columns known to be
/// independent.
class PlainQr {
 public:
  explicit PlainQr(const Eigen::MatrixXd& columns);

  /// Least-squares solution.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  /// Orthonormal, of the space of the columns: as many as these, and no more than rows.
  [[nodiscard]] Eigen::MatrixXd basis() const;
  /// Of a vector from the space of the columns.
  [[nodiscard]] double squared_distance(const Eigen::VectorXd& from) const;
  /// Solution x of R x = right.
  [[nodiscard]] Eigen::VectorXd solve_triangle(const Eigen::VectorXd& right) const;
  /// C with C' columns = 1, in the space of the columns: the transposed pseudo-inverse.
  [[nodiscard]] Eigen::MatrixXd dual() const;

 private:
  using Factors = Eigen::HouseholderQR<Eigen::MatrixXd>;
  std::shared_ptr<const Factors> factors_;
};

/// L L' = a symmetric matrix; only its lower triangle is read.
class CholeskyFactor {
 public:
  explicit CholeskyFactor(const Eigen::MatrixXd& matrix);

  /// Whether the matrix is positive definite, to rounding; else there is no factor.
  [[nodiscard]] bool exists() const;
  /// Of L.
  [[nodiscard]] Eigen::VectorXd diagonal() const;
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  using Factor = Eigen::LLT<Eigen::MatrixXd>;
  std::shared_ptr<const Factor> factor_;
};

/// Right-hand part of U diag(values) V' = matrix, largest singular value first.
struct RightSingularVectors {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;  // V
};
[[nodiscard]] RightSingularVectors right_singular_vectors(const Eigen::MatrixXd& matrix);

/// The shortest of all x with least |matrix x - right|, column by column, whatever the rank.
[[nodiscard]] Eigen::MatrixXd shortest_solution(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Solution for a regular square matrix whose rows may be of any sizes, by L U.
[[nodiscard]] Eigen::MatrixXd solve_square(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// Solution for a symmetric matrix that is not indefinite, by L D L'; only the lower triangle is read.
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& right);

}  // namespace frac::detail
