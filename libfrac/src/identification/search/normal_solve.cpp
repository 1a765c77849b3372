// SPDX-License-Identifier: BSD-3-Clause
#include "normal_solve.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "base/gram_schmidt.hpp"
#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;

/// The cost of residuals and priors at a place, and their normal equations.
struct Place {
  double cost = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
};

/// Linearises residuals and priors, with buffers for all of one solve.
class Linearised {
 public:
  explicit Linearised(const Residuals& residuals)
      : residuals_(residuals),
        width_(static_cast<Index>(residuals.map().free().size())),
        columns_(static_cast<Index>(residuals.count()), width_ + 1) {
    if (!residuals.priors()) return;
    distance_.resize(static_cast<Index>(residuals.priors()->entries().size()));
    by_theta_.resize(distance_.size(), width_);
  }

  /// False where the model is not finite.
  bool at(const std::vector<double>& theta, Place& place) {
    throw_if_cancelled();
    if (!residuals_.evaluate(theta, columns_.col(width_).data(), columns_.data())) return false;
    const Eigen::MatrixXd products = products_of(columns_);
    auto& [cost, matrix, gradient] = place;
    matrix = products.topLeftCorner(width_, width_);
    gradient = products.col(width_).head(width_);
    cost = products(width_, width_);
    if (const Priors* const priors = residuals_.priors()) {
      if (!priors->evaluate(residuals_.map(), theta, distance_.data(), by_theta_.data())) return false;
      const double squared_weight = std::pow(residuals_.prior_weight(), 2);
      cost += squared_weight * distance_.squaredNorm();
      gradient += squared_weight * (by_theta_.transpose() * distance_);
      matrix += squared_weight * (by_theta_.transpose() * by_theta_);
    }
    return std::isfinite(cost) && matrix.allFinite();
  }

 private:
  const Residuals& residuals_;
  Index width_;
  Eigen::MatrixXd columns_;  // of the Jacobian, and the residual
  Eigen::VectorXd distance_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_theta_;
};

}  // namespace

// Steps, damping and bounds are those of Ceres: a step in units of the first Jacobian's columns, damped by 1/radius of
// the curvature, then cut at the bounds.  With steps that heed the bounds from the beginning scouts stay at a bound
// where a lower minimum lies inside: 25 of 5300 rows of rankings missed their optimum by 1 %
// (tests/benchmarks/ranking_rates), with these 19.
LocalSolution normal_solve(const Residuals& residuals, const std::vector<double>& start, const LocalOptions& options) {
  Linearised linearised(residuals);
  Place here, there;
  const bool exists = linearised.at(start, here);
  LocalSolution solution{start, here.cost, here.cost, false};
  if (!exists) return solution;
  const Eigen::VectorXd unit = (1 + here.matrix.diagonal().array().sqrt()).inverse();
  // What the data do not see is damped as if it had this curvature; a step is taken for this share of the gain that it
  // lets expect.
  constexpr double unseen = 1e-6, least_share = 1e-3;
  double radius = options.radius, shrinking = 2;
  for (int iteration = 0; iteration < options.iterations && !solution.converged; ++iteration) {
    Eigen::MatrixXd damped = unit.asDiagonal() * here.matrix * unit.asDiagonal();
    damped.diagonal() += damped.diagonal().cwiseMax(unseen) / radius;
    const CholeskyFactor factor(damped);
    double share = 0;  // of the expected gain
    if (factor.exists()) {
      const Eigen::VectorXd step = -unit.cwiseProduct(factor.solve(unit.cwiseProduct(here.gradient)));
      const double expected = -step.dot(2 * here.gradient + here.matrix * step);
      const double negligible = options.cost_tolerance * here.cost;
      if (!(expected > negligible)) {
        solution.converged = true;
        break;
      }
      std::vector<double> next = solution.theta;
      for (std::size_t k = 0; k < next.size(); ++k) {
        const ParameterMap::Free& bounds = residuals.map().free()[k];
        next[k] = std::clamp(next[k] + step[static_cast<Index>(k)], bounds.lower, bounds.upper);
      }
      if (linearised.at(next, there)) {
        const double gain = here.cost - there.cost;
        solution.converged = std::abs(gain) <= negligible;
        share = gain / expected;
      }
      if (share > least_share) {
        solution.theta = std::move(next);
        std::swap(here, there);
      }
    }
    if (share > least_share) {
      radius /= std::max(1.0 / 3, 1 - std::pow(2 * share - 1, 3));
      shrinking = 2;
    } else {
      radius /= shrinking;
      shrinking *= 2;
    }
  }
  solution.cost = solution.objective = here.cost;
  return solution;
}

}  // namespace frac::detail
