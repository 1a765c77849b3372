// SPDX-License-Identifier: BSD-3-Clause
#include "flat_directions.hpp"

#include <optional>

#include "base/linear_algebra.hpp"
#include "linearisation.hpp"

namespace frac::detail {

std::vector<std::vector<double>> flat_directions(const Residuals& residuals, const LocalSolution& solution,
                                                 double times) {
  const std::optional<Linearisation> at_best = linearised(residuals, solution.theta);
  if (!at_best) return {};
  const auto [values, vectors] = right_singular_vectors(at_best->reduced());
  std::vector<std::vector<double>> directions;
  for (Eigen::Index k = values.size(); k-- > 0;) {
    const Eigen::VectorXd direction = vectors.col(k) / vectors.col(k).lpNorm<Eigen::Infinity>();
    const double rise = values[k] * direction.norm();
    if (!(rise * rise <= times * solution.cost)) continue;
    directions.emplace_back(direction.begin(), direction.end());
  }
  return directions;
}

}  // namespace frac::detail
