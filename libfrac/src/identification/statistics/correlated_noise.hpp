// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace frac::detail {

/// How residuals of a least-squares fit follow each other, and what that does to the errors of the estimates.
///
/// The noise is either white or of first order, e_i = r e_(i-1) + white with 0 < r < 1, each with probability 1/2
/// beforehand and every r alike.  The likelihood of r is that of the residuals with the fitted columns integrated out
/// (restricted likelihood), so that the share of the noise the parameters have taken does not hide r.  Nothing is
/// decided between the two: variances are averaged with the probabilities the residuals give to each r, so that little
/// is added where neighbours are unrelated and uncertainty about r is counted.
class CorrelatedNoise {
 public:
  /// White noise, for results that have no residuals to tell.
  CorrelatedNoise() = default;
  /// @param residual  as left by least squares, points in order with `per_point` of each, which make as many series
  /// @param columns   span of what was fitted: count x parameters
  CorrelatedNoise(std::span<const double> residual, const Eigen::MatrixXd& columns, std::size_t per_point);

  /// Mean of r over its probabilities, white noise counting as 0.
  [[nodiscard]] double correlation() const noexcept { return correlation_; }
  /// Probability that neighbours are correlated.
  [[nodiscard]] double chance() const noexcept { return chance_; }
  /// Standard deviation of influence' * noise over that in white noise with the variance of the residuals.
  [[nodiscard]] double widening(const Eigen::VectorXd& influence) const;

 private:
  struct Possibility {
    double correlation, probability;
    double variance;  // of one value, over that of white noise told from the same residuals
  };
  std::vector<Possibility> possibilities_;
  std::size_t per_point_ = 1;
  double correlation_ = 0, chance_ = 0;
};

}  // namespace frac::detail
