// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "smooth_error.hpp"

namespace frac::detail {

/// How residuals of a least-squares fit follow each other, and what that does to the errors of the estimates.
///
/// One of three is true: the noise is white; or it is of first order, e_i = r e_(i-1) + white with 0 < r < 1, every r
/// alike beforehand; or it is white beside a smooth error (SmoothError), every ratio of its variance to that of the
/// noise and every length of it alike in its logarithm.  The three are alike beforehand too.  The likelihood is that of
/// the residuals with the fitted columns integrated out (restricted likelihood), so that the share of the noise the
/// parameters have taken does not hide the others.  Nothing is decided between the three: variances are averaged with
/// the probabilities that the residuals give to each, so that little is added where neighbours are unrelated, and what
/// the residuals leave open is counted.
class CorrelatedNoise {
 public:
  /// White noise, for results that have no residuals to tell.
  CorrelatedNoise() = default;
  /// @param residuals  as left by least squares
  /// @param basis      orthonormal, of the space of what was fitted: count x parameters
  /// @param axis       without positions there is no smooth error to think of
  CorrelatedNoise(std::span<const double> residuals, const Eigen::Ref<const Eigen::MatrixXd>& basis,
                  const ResidualAxis& axis);

  /// Mean of r over its probabilities, without correlation counting as 0.
  [[nodiscard]] double correlation() const noexcept { return correlation_; }
  /// Probability that neighbours are correlated, as noise of first order or by a smooth error; that of the latter.
  [[nodiscard]] double chance() const noexcept { return chance_; }
  [[nodiscard]] double smooth_chance() const noexcept { return smooth_chance_; }
  /// Root mean square of the smooth error, in the unit of the residuals: the mean over what is possible.
  [[nodiscard]] double smooth_error() const noexcept { return smooth_error_; }
  /// Covariance of columns' * noise, over the variance of white noise told from the same residuals.
  [[nodiscard]] Eigen::MatrixXd covariance(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

 private:
  struct Possibility {
    double probability;
    double variance;               // of one value, over that of white noise told from the same residuals
    double correlation;            // of first order
    double share = 0, length = 0;  // of a smooth error: its part of that variance, on the mean over its sizes
  };
  void add_first_order(std::span<const double> residual, const Eigen::Ref<const Eigen::MatrixXd>& basis,
                       double white_variance);
  void add_smooth(double white_variance);

  std::vector<Possibility> possibilities_;
  std::optional<SmoothError> smooth_;
  std::size_t per_point_ = 1;
  double correlation_ = 0, chance_ = 0, smooth_chance_ = 0, smooth_error_ = 0;
};

}  // namespace frac::detail
