// SPDX-License-Identifier: BSD-3-Clause
#include "correlated_noise.hpp"

#include <algorithm>
#include <boost/math/constants/constants.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "restricted_likelihood.hpp"

namespace frac::detail {
namespace {

/// Beyond this correlation a record looks like a drift, and its level is not determined.
constexpr double most_correlation = 0.98;

/// Variance of influence' * noise for noise of unit variance and correlation r^lag.
double variance_under(double r, const Eigen::VectorXd& influence, std::size_t per_point) {
  const auto stride = static_cast<Eigen::Index>(per_point);
  double sum = 0;
  for (Eigen::Index part = 0; part < stride; ++part) {
    double carried = 0;  // sum of the earlier values, each times r per point since
    for (Eigen::Index i = part; i < influence.size(); i += stride) {
      sum += influence[i] * (influence[i] + 2 * carried);
      carried = r * (carried + influence[i]);
    }
  }
  return sum;
}

/// Probabilities beforehand.  With these, intervals hold 96 to 98 % in white noise and 84 to 97 % beside a smooth error
/// of 0.3 to 3 % (interval_coverage smooth, 40 and 200 points, a fresh seed).  With equal ones it is 99 %, and 83 to 98
/// %: what is missing is the part of the error that the parameters take, of which residuals tell nothing.
constexpr double of_white = 0.6, of_first_order = 0.3, of_smooth = 0.1;

}  // namespace

CorrelatedNoise::CorrelatedNoise(std::span<const double> residual, const Eigen::MatrixXd& columns,
                                 const ResidualAxis& axis)
    : per_point_(axis.per_point) {
  double square = 0;
  for (const double each : residual) square += each * each;
  const Eigen::MatrixXd basis = PivotedQr(columns).basis();
  const double degrees = static_cast<double>(residual.size()) - static_cast<double>(basis.cols());
  constexpr double fewest_degrees = 4;
  if (!(degrees >= fewest_degrees) || !(square > 0) || residual.size() < 4 * per_point_) return;

  // Logarithms of probabilities at first, all of the same likelihood.
  const double white_variance = square / degrees;
  possibilities_.push_back({std::log(of_white) - 0.5 * degrees * std::log(square), 1, 0});
  add_first_order(residual, basis, white_variance);
  if (!axis.position.empty() && axis.position.back() > axis.position.front()) {
    smooth_.emplace(residual, basis, axis);
    add_smooth(white_variance);
  }
  double highest = possibilities_.front().probability, total = 0;
  for (const Possibility& each : possibilities_) highest = std::max(highest, each.probability);
  for (Possibility& each : possibilities_) total += each.probability = std::exp(each.probability - highest);
  double smooth_square = 0;
  for (Possibility& each : possibilities_) {
    each.probability /= total;
    correlation_ += each.probability * each.correlation;
    if (each.correlation > 0 || each.share > 0) chance_ += each.probability;
    if (each.share > 0) smooth_chance_ += each.probability;
    smooth_square += each.probability * each.share * each.variance * white_variance;
  }
  smooth_error_ = std::sqrt(smooth_square);
}

void CorrelatedNoise::add_first_order(std::span<const double> residual, const Eigen::MatrixXd& basis,
                                      double white_variance) {
  const RestrictedLikelihood likelihood(residual, basis, per_point_);
  // In Fisher's z = atanh r the likelihood is about normal, of width 1/sqrt(n) around its maximum.
  const double last = std::atanh(most_correlation);
  constexpr int coarse = 24, fine = 32;
  double best = 0, highest = likelihood.at(0).logarithm;
  for (int i = 1; i <= coarse; ++i) {
    const double z = last * i / coarse, here = likelihood.at(std::tanh(z)).logarithm;
    if (here > highest) {
      highest = here;
      best = z;
    }
  }
  const double reach = 5 / std::sqrt(static_cast<double>(residual.size())) + last / coarse;
  const double first = std::max(0.0, best - reach), step = (std::min(last, best + reach) - first) / fine;
  for (int i = 0; i < fine; ++i) {
    const double r = std::tanh(first + (i + 0.5) * step);
    const RestrictedLikelihood::Value value = likelihood.at(r);
    const double slab = (1 - r * r) * step / most_correlation;  // dr for dz
    possibilities_.push_back(
        {std::log(of_first_order * slab) + value.logarithm, value.innovation / (1 - r * r) / white_variance, r});
  }
}

void CorrelatedNoise::add_smooth(double white_variance) {
  constexpr int lengths = 5;
  // The share h as the logarithm of h/(1 - h): from what no data tell to noise of a thousandth of the smooth error.
  constexpr double least = -7, most = 14;
  constexpr int bits = 6;  // of the logarithm of the most likely share: a tenth of the least width of its peak
  const double ratio = std::log(smooth_->longest() / smooth_->shortest()) / (lengths - 1);
  for (int i = 0; i < lengths; ++i) {
    const double length = smooth_->shortest() * std::exp(i * ratio);
    const auto share_of = [](double logit) { return 1 / (1 + std::exp(-logit)); };
    // With dh = h (1 - h) d logit, which makes the peak an inner one.
    const auto minus_logarithm = [&](double logit) {
      const double share = share_of(logit);
      return -smooth_->at(share, length).logarithm - std::log(share * (1 - share));
    };
    const auto [peak, value] = boost::math::tools::brent_find_minima(minus_logarithm, least, most, bits);
    constexpr double aside = 0.3;
    const double curvature =
        (minus_logarithm(peak + aside) + minus_logarithm(peak - aside) - 2 * value) / (aside * aside);
    // That of h (1 - h) alone is 2 h (1 - h), which a likelihood that tells nothing leaves: 1/2 at its own peak.
    const double width = 1 / std::sqrt(std::max(curvature, 0.25));
    // Gauss and Hermite's rule of three points.
    for (const auto& [place, weight] :
         {std::pair{-std::sqrt(3.0), 1.0 / 6}, {0.0, 2.0 / 3}, {std::sqrt(3.0), 1.0 / 6}}) {
      const double share = share_of(peak + place * width);
      const double mass = of_smooth / lengths * weight * width * boost::math::constants::root_two_pi<double>();
      possibilities_.push_back(
          {std::log(mass) - value, smooth_->at(share, length).variance / white_variance, 0, share, length});
    }
  }
}

double CorrelatedNoise::widening(const Eigen::VectorXd& unscaled) const {
  const double largest = unscaled.size() > 0 ? unscaled.lpNorm<Eigen::Infinity>() : 0;
  if (possibilities_.empty() || !(largest > 0)) return 1;
  // The size of the influence cancels; its squares would vanish or overflow for parameters of 1e-200 or 1e200.
  const Eigen::VectorXd influence = unscaled / largest;
  std::optional<SmoothError::Influence> sums;
  if (smooth_) sums = smooth_->influence(influence);
  double variance = 0;
  for (const Possibility& each : possibilities_) {
    if (each.probability < 1e-6) continue;
    variance += each.probability * each.variance *
                (each.share > 0 ? smooth_->variance(*sums, each.share, each.length)
                                : variance_under(each.correlation, influence, per_point_));
  }
  return std::sqrt(variance / influence.squaredNorm());
}

}  // namespace frac::detail
