// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/triangular_form.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace {

using Eigen::MatrixXd;

MatrixXd triangle_of(const MatrixXd& jacobian, const Eigen::VectorXd& residual) {
  const auto columns = static_cast<std::size_t>(jacobian.cols() + 1);
  std::vector<double> triangle(columns * columns);
  frac::detail::triangular_form({jacobian.data(), static_cast<std::size_t>(jacobian.size())},
                                {residual.data(), static_cast<std::size_t>(residual.size())}, triangle);
  return Eigen::Map<const Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(
      triangle.data(), static_cast<Eigen::Index>(columns), static_cast<Eigen::Index>(columns));
}

// Householder's reduction is that of a matrix within about rows x columns units of rounding of each column's length
// (Higham 2002, theorem 19.4), so scalar products of columns agree to twice that times both lengths, however unequal.
// Row counts below, at and across the block of 64; columns of very different size; fewer rows than columns.
TEST(TriangularForm, KeepsScalarProductsOfColumns) {
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  for (const Eigen::Index rows : {3, 63, 64, 65, 400}) {
    MatrixXd all(rows, 6);
    for (double& each : all.reshaped()) each = normal(generator);
    all.col(1) *= 1e-9;
    all.col(2) = 1e6 * (all.col(0) + 1e-7 * all.col(2));
    const MatrixXd triangle = triangle_of(all.leftCols(5), all.col(5));
    for (Eigen::Index i = 0; i < 6; ++i) {
      for (Eigen::Index j = 0; j < 6; ++j) {
        if (i > j) {
          EXPECT_EQ(triangle(i, j), 0);
        }
        const double bound = 2 * 6 * static_cast<double>(rows) * std::numeric_limits<double>::epsilon() *
                             all.col(i).norm() * all.col(j).norm();
        EXPECT_NEAR(triangle.col(i).dot(triangle.col(j)), all.col(i).dot(all.col(j)), bound) << rows << ' ' << i << j;
      }
    }
  }
}

// The squared length of what no combination of columns can reach is the last entry squared: here 3 of (1, 2, 3) in the
// third direction.
TEST(TriangularForm, EndsWithTheLengthOfTheRest) {
  const MatrixXd jacobian{{2, 1}, {0, 1}, {0, 0}};
  const MatrixXd triangle = triangle_of(jacobian, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(std::abs(triangle(2, 2)), 3, 1e-15);
  EXPECT_NEAR(std::abs(triangle(1, 1)), 1, 1e-15);
}

TEST(TriangularForm, LeavesColumnsOfZeros) {
  const MatrixXd triangle = triangle_of(MatrixXd::Zero(10, 2), Eigen::VectorXd::Ones(10));
  EXPECT_EQ(triangle.leftCols(2).norm(), 0);
  EXPECT_NEAR(triangle.col(2).norm(), std::sqrt(10.0), 1e-15 * 10);
}

// What is not finite stays not finite, so that nobody takes a step from it.
TEST(TriangularForm, PassesOnWhatIsNotFinite) {
  MatrixXd jacobian = MatrixXd::Ones(5, 2);
  jacobian(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(triangle_of(jacobian, Eigen::VectorXd::Ones(5)).allFinite());
}

}  // namespace
