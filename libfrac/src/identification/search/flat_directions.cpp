// SPDX-License-Identifier: BSD-3-Clause
#include "flat_directions.hpp"

#include <Eigen/SVD>
#include <optional>

#include "reduced_jacobian.hpp"

namespace frac::detail {

std::vector<std::vector<double>> flat_directions(const Residuals& residuals, const LocalSolution& solution,
                                                 double times) {
  std::vector<double> residual;
  const std::optional<Eigen::MatrixXd> jacobian = reduced_jacobian(residuals, solution.theta, residual);
  if (!jacobian) return {};
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(*jacobian, Eigen::ComputeThinV);
  std::vector<std::vector<double>> directions;
  for (Eigen::Index k = jacobian->cols(); k-- > 0;) {
    const Eigen::VectorXd direction = svd.matrixV().col(k) / svd.matrixV().col(k).lpNorm<Eigen::Infinity>();
    const double rise = svd.singularValues()[k] * direction.norm();
    if (!(rise * rise <= times * solution.cost)) continue;
    directions.emplace_back(direction.begin(), direction.end());
  }
  return directions;
}

}  // namespace frac::detail
