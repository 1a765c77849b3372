// SPDX-License-Identifier: BSD-3-Clause
#include "correlated_noise.hpp"

#include <algorithm>
#include <cmath>

#include "restricted_likelihood.hpp"

namespace frac::detail {
namespace {

/// Beyond this correlation a record looks like a drift, and its level is not determined.
constexpr double most_correlation = 0.98;

/// Adds to each row of a sum all earlier rows of the columns, each times r per point since then and times a factor.
void add_earlier(double factor, double r, const Eigen::Ref<const Eigen::MatrixXd>& columns, std::size_t per_point,
                 Eigen::MatrixXd& sum) {
  const auto stride = static_cast<Eigen::Index>(per_point);
  for (Eigen::Index column = 0; column < columns.cols(); ++column) {
    for (Eigen::Index part = 0; part < stride; ++part) {
      double carried = 0;
      for (Eigen::Index i = part; i < columns.rows(); i += stride) {
        sum(i, column) += factor * carried;
        carried = r * (carried + columns(i, column));
      }
    }
  }
}

}  // namespace

CorrelatedNoise::CorrelatedNoise(std::span<const double> residuals, const Eigen::Ref<const Eigen::MatrixXd>& basis,
                                 const ResidualAxis& axis)
    : per_point_(axis.per_point) {
  // Of size 1: those of exact data are as small as the errors by which they are orthogonal to the columns.
  Eigen::VectorXd scaled = Eigen::Map<const Eigen::VectorXd>(residuals.data(), std::ssize(residuals));
  const double size = scaled.size() > 0 ? scaled.lpNorm<Eigen::Infinity>() : 0;
  if (!(size > 0) || !std::isfinite(size)) return;
  scaled /= size;
  const std::span<const double> residual(scaled.data(), residuals.size());
  const double square = scaled.squaredNorm();
  const double degrees = static_cast<double>(residual.size()) - static_cast<double>(basis.cols());
  constexpr double fewest_degrees = 4;
  if (!(degrees >= fewest_degrees) || residual.size() < 4 * per_point_) return;

  // Logarithms of probabilities at first, all of the same likelihood.
  const double white_variance = square / degrees;
  possibilities_.push_back({-0.5 * degrees * std::log(square), 1, 0});
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
  smooth_error_ = size * std::sqrt(smooth_square);
}

void CorrelatedNoise::add_first_order(std::span<const double> residual, const Eigen::Ref<const Eigen::MatrixXd>& basis,
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
    possibilities_.push_back({std::log(slab) + value.logarithm, value.innovation / (1 - r * r) / white_variance, r});
  }
}

void CorrelatedNoise::add_smooth(double white_variance) {
  constexpr int lengths = 5;
  // The share h as the logarithm of h/(1 - h): from what no data tell to noise of a thousandth of the smooth error. The
  // likelihood is a sum of functions of it that change over 1, which parabolas through three neighbours follow.
  constexpr int least = -7, most = 14, refined = 8;
  const auto share_of = [](double logit) { return 1 / (1 + std::exp(-logit)); };
  std::vector<double> shares;
  for (int logit = least; logit <= most; ++logit) shares.push_back(share_of(logit));
  const double ratio = std::log(smooth_->longest() / smooth_->shortest()) / (lengths - 1);
  for (int i = 0; i < lengths; ++i) {
    const double length = smooth_->shortest() * std::exp(i * ratio);
    std::vector<double> logarithms, variances;
    for (const SmoothError::Likelihood& found : smooth_->at(shares, length)) {
      logarithms.push_back(found.logarithm);
      variances.push_back(std::log(found.variance / white_variance));
    }
    // Residuals that lie among the columns to rounding tell nothing.
    if (!std::all_of(logarithms.begin(), logarithms.end(), [](double each) { return std::isfinite(each); })) return;
    const double highest = *std::max_element(logarithms.begin(), logarithms.end());
    double mass = 0, whole = 0, smooth = 0;
    const int places = (most - least) * refined;
    for (int k = 0; k < places; ++k) {
      const double at = (k + 0.5) / refined;
      const int node = std::clamp(static_cast<int>(std::lround(at)), 1, most - least - 1);
      const auto between = [&](const std::vector<double>& values) {
        const double* const v = &values[static_cast<std::size_t>(node)];
        const double x = at - node;
        return v[0] + x * ((v[1] - v[-1]) + x * (v[1] - 2 * v[0] + v[-1])) / 2;
      };
      const double each = std::exp(between(logarithms) - highest), weighed = each * std::exp(between(variances));
      mass += each;
      whole += weighed;
      smooth += weighed * share_of(least + at);
    }
    possibilities_.push_back({highest + std::log(mass / (places * lengths)), whole / mass, 0, smooth / whole, length});
  }
}

Eigen::MatrixXd CorrelatedNoise::covariance(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  if (possibilities_.empty()) return columns.transpose() * columns;
  std::vector<SmoothError::Possibility> smooth;
  double variance = 0;
  // Of each row half of itself and all earlier ones, by their covariance with it: products with the rows and their
  // transpose count each pair twice.
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(columns.rows(), columns.cols());
  for (const Possibility& each : possibilities_) {
    if (each.probability < 1e-6) continue;
    const double weight = each.probability * each.variance;
    if (each.share > 0) {
      smooth.push_back({weight, each.share, each.length});
      continue;
    }
    variance += weight;
    if (each.correlation > 0) add_earlier(weight, each.correlation, columns, per_point_, half);
  }
  half += 0.5 * variance * columns;
  Eigen::MatrixXd covariance = columns.transpose() * half;
  covariance += covariance.transpose().eval();
  if (!smooth.empty()) covariance += smooth_->covariance(smooth_->influences(columns), smooth);
  return covariance;
}

}  // namespace frac::detail
