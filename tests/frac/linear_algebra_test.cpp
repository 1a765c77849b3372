// SPDX-License-Identifier: BSD-3-Clause
#include "base/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <random>

#include "base/gram_schmidt.hpp"

namespace {

using frac::detail::PlainQr;

// Numbers between -1 and 1.
Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return number(generator); });
}

// What products of such matrices of at most ten rows, whose singular values are at least 1e-3, keep of 1e-16 with room
// to spare.
constexpr double rounding = 1e-11;

TEST(PlainQr, DualTimesColumnsIsTheIdentity) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Eigen::MatrixXd columns = random_matrix(9, 4, seed);
    const PlainQr qr(columns);
    const Eigen::MatrixXd dual = qr.dual();
    EXPECT_LT((dual.transpose() * columns - Eigen::MatrixXd::Identity(4, 4)).norm(), rounding);
    // In the space of the columns: nothing is left beside it.
    EXPECT_LT((dual - qr.basis() * (qr.basis().transpose() * dual)).norm(), rounding);
  }
}

// The conditions of Penrose, of which the solution for the identity, the pseudo-inverse, is the only one that holds
// all.
TEST(ShortestSolution, IsThatOfThePseudoInverse) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const auto& [rows, inner, columns] : {std::array{6, 3, 8}, {8, 3, 6}, {4, 4, 7}, {7, 4, 4}, {5, 1, 5}}) {
      const Eigen::MatrixXd matrix = random_matrix(rows, inner, 2 * seed) * random_matrix(inner, columns, 2 * seed + 1);
      const Eigen::MatrixXd inverse = frac::detail::shortest_solution(matrix, Eigen::MatrixXd::Identity(rows, rows));
      const double size = inverse.norm();
      EXPECT_LT((matrix * inverse * matrix - matrix).norm(), rounding * size);
      EXPECT_LT((inverse * matrix * inverse - inverse).norm(), rounding * size * size);
      EXPECT_LT((matrix * inverse - (matrix * inverse).transpose()).norm(), rounding * size);
      EXPECT_LT((inverse * matrix - (inverse * matrix).transpose()).norm(), rounding * size);
    }
  }
}

TEST(ShortestSolution, IsZeroForAZeroMatrix) {
  const Eigen::MatrixXd solution =
      frac::detail::shortest_solution(Eigen::MatrixXd::Zero(3, 2), Eigen::MatrixXd::Ones(3, 1));
  EXPECT_EQ(solution, Eigen::MatrixXd::Zero(2, 1));
}

// Against Householder's reflections, of random columns of which the third is nearly and the last exactly in the space
// of others.
TEST(Orthonormalised, AgreesWithReflections) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    for (const Eigen::Index rows : {7, 8, 33}) {
      Eigen::MatrixXd columns = random_matrix(rows, 6, seed);
      columns.col(2) = columns.col(0) - 2 * columns.col(1) + 1e-7 * columns.col(2);
      columns.col(5) = columns.col(3) + columns.col(4);
      const Eigen::VectorXd vector = random_matrix(rows, 1, seed + 100);
      const frac::detail::Orthonormalised apart = frac::detail::orthonormalised(columns, vector, 1e-11);
      const frac::detail::PivotedQr reflected(columns, 1e-11);
      ASSERT_EQ(apart.basis.cols(), 5);
      // Twice orthogonalised: orthonormal to rounding although a column lies at 1e-7 of its length from the others.
      EXPECT_LT((apart.basis.transpose() * apart.basis - Eigen::MatrixXd::Identity(5, 5)).norm(), 1e-13);
      Eigen::MatrixXd in_order(rows, 6);
      for (Eigen::Index k = 0; k < 6; ++k) in_order.col(k) = columns.col(apart.order[static_cast<std::size_t>(k)]);
      EXPECT_LT((apart.basis * apart.triangle.topRows(5) - in_order).norm(), 1e-13);
      // A direction is known to 1e7 times rounding, and that times the condition of the others.
      const Eigen::MatrixXd basis = reflected.basis();
      EXPECT_LT((apart.rest - (vector - basis * (basis.transpose() * vector))).norm(), 1e-7);
      EXPECT_LT((apart.basis * apart.share + apart.rest - vector).norm(), 1e-13);
      EXPECT_LT((columns * apart.solution() + apart.rest - vector).norm(), 1e-7);
      EXPECT_EQ((apart.solution().array() != 0).count(), 5);
    }
  }
}

// Sums of as many products of normal numbers as there are rows, each within rounding times rows of itself.
TEST(ProductsOfColumns, AreThoseOfEigen) {
  for (const Eigen::Index rows : {1, 3, 4, 31, 120}) {
    for (const Eigen::Index count : {1, 4, 5, 11}) {
      const Eigen::MatrixXd columns = random_matrix(rows, count, 7);
      const Eigen::MatrixXd products = frac::detail::products_of(columns);
      EXPECT_LT((products - columns.transpose() * columns).norm(), 1e-15 * static_cast<double>(rows * count));
      EXPECT_EQ(products, products.transpose());
    }
  }
}

TEST(RemoveSpan, LeavesWhatIsBesideTheBasis) {
  for (const Eigen::Index rows : {5, 12, 31}) {
    const Eigen::MatrixXd basis = frac::detail::PivotedQr(random_matrix(rows, 3, 1)).basis();
    Eigen::MatrixXd columns = random_matrix(rows, 6, 2);
    const Eigen::MatrixXd expected = columns - basis * (basis.transpose() * columns);
    frac::detail::remove_span(basis, columns);
    EXPECT_LT((columns - expected).norm(), 1e-13);
  }
}

}  // namespace
