// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// What residuals are taken to scatter by.
struct ResidualScatter {
  double widening;        // factor on the standard errors
  double least_variance;  // that the residuals count as, over their deviations
};

/// What the Fisher matrix at an estimate says of the quantities that follow from its coordinates.
/// Coordinates at an ideal of the family are no limit of the scene: the intervals of others hold for all values that
/// the data allow them.
class SceneUncertainty {
 public:
  /// @param family  stays with the caller
  SceneUncertainty(const SceneFamily& family, const Coordinates& theta, const NormalEquations& equations,
                   const ResidualScatter& scatter);

  [[nodiscard]] const Coordinates& theta() const noexcept { return theta_; }
  /// With its interval, whatever limits and fixed coordinates say of it.
  [[nodiscard]] SceneEstimate open_estimate(const Quantity& quantity) const;
  /// A quantity whose coordinates are all fixed is known; where one that limits it is at its limit nothing tells how
  /// far it might go.
  [[nodiscard]] SceneEstimate estimate(const Quantity& quantity) const;
  /// Of the directions that the Fisher matrix gives, as long as the standard errors are.  NaN beside a quantity without
  /// one, 0 beside one that is fixed.
  [[nodiscard]] std::vector<std::vector<double>> covariance(const std::vector<Quantity>& quantities) const;

  /// One sentence per direction in the space of the coordinates that the data leave free.
  [[nodiscard]] std::vector<std::string> free_directions() const;
  /// One sentence per parameter at a limit beyond which the data pull it by more than their noise does.
  [[nodiscard]] std::vector<std::string> strained() const;
  [[nodiscard]] double condition() const noexcept { return condition_; }
  /// Directions determined, coordinates at a limit among them.
  [[nodiscard]] std::size_t rank() const noexcept { return rank_; }

 private:
  void decompose();
  /// Gradient by the lengths of the columns.
  [[nodiscard]] Eigen::VectorXd scaled(const std::vector<double>& gradient) const;
  [[nodiscard]] double covariance_of(const Quantity& one, const Quantity& other) const;
  [[nodiscard]] Eigen::MatrixXd jackknife() const;
  [[nodiscard]] double pull(std::size_t at_limit) const;
  [[nodiscard]] std::string direction_text(Eigen::Index direction) const;

  const SceneFamily& family_;
  Coordinates theta_;
  NormalEquations equations_;
  std::vector<bool> at_bound_;
  std::vector<bool> inner_;      // free, and not at a limit
  Eigen::VectorXd column_;       // lengths; 0 where the residuals see nothing
  Eigen::VectorXd eigenvalues_;  // of the scaled matrix, the smallest first
  Eigen::MatrixXd eigenvectors_;
  std::vector<bool> is_free_;  // directions
  std::size_t rank_ = 0;
  double condition_ = 1;
  double variance_ = 0;        // of the residuals, widened
  double t_ = 0;               // half width of an interval in standard errors
  Eigen::MatrixXd jackknife_;  // covariance, widened
};

/// Whether the interval is no wider than the value, or the range of restitution: what `identified` asks for.  False
/// without an interval, as at a limit.
[[nodiscard]] bool is_narrow(const SceneEstimate& estimate);

/// Estimates with their 95 % intervals line by line, and the message.
[[nodiscard]] std::string summary_of(std::span<const SceneEstimate> parameters, const std::string& message);

}  // namespace backlash::detail
