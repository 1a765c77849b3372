// SPDX-License-Identifier: BSD-3-Clause
#include "base/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <random>

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

}  // namespace
