// SPDX-License-Identifier: BSD-3-Clause
#include "correlated_noise.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"

namespace frac::detail {
namespace {

/// Beyond this correlation a record looks like a drift, and its level is not determined.
constexpr double most_correlation = 0.98;

/// Restricted likelihood of the correlation r of residuals.  The inverse covariance of first-order noise with unit
/// innovations is 1 - r N + r^2 D, with N the sum of both shifts by a point and D the identity without the first and
/// last point of each series, so that three small matrices serve every r.
class RestrictedLikelihood {
 public:
  RestrictedLikelihood(std::span<const double> residual, const Eigen::MatrixXd& columns, std::size_t per_point)
      : count_(static_cast<double>(residual.size())), series_(static_cast<double>(per_point)) {
    const auto rows = static_cast<Eigen::Index>(residual.size());
    const auto stride = static_cast<Eigen::Index>(per_point);
    const PivotedQr qr(columns);
    width_ = qr.rank();
    const Eigen::MatrixXd basis = qr.basis();
    Eigen::MatrixXd all(rows, width_ + 1);
    all << basis, Eigen::Map<const Eigen::VectorXd>(residual.data(), rows);
    const Eigen::Index inner = rows - stride;
    whole_ = all.transpose() * all;
    const Eigen::MatrixXd product = all.topRows(inner).transpose() * all.bottomRows(inner);
    neighbours_ = product + product.transpose();
    const Eigen::MatrixXd middle = all.middleRows(stride, std::max<Eigen::Index>(rows - 2 * stride, 0));
    middle_ = middle.transpose() * middle;
  }

  [[nodiscard]] double degrees() const { return count_ - static_cast<double>(width_); }

  struct Value {
    double logarithm;
    double innovation;  // variance of the white noise that drives the first-order one
  };
  [[nodiscard]] Value at(double r) const {
    const Eigen::MatrixXd all = whole_ - r * neighbours_ + r * r * middle_;
    const Eigen::VectorXd factor = CholeskyFactor(all).diagonal();
    // The last diagonal entry is the length of the residual once the columns are fitted to it anew.
    double logarithm = 0.5 * series_ * std::log(1 - r * r);
    for (Eigen::Index i = 0; i < width_; ++i) logarithm -= std::log(factor(i));
    const double length = factor(width_);
    return {logarithm - degrees() * std::log(length), length * length / degrees()};
  }

 private:
  double count_, series_;
  Eigen::Index width_;
  Eigen::MatrixXd whole_, neighbours_, middle_;
};

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

}  // namespace

CorrelatedNoise::CorrelatedNoise(std::span<const double> residual, const Eigen::MatrixXd& columns,
                                 std::size_t per_point)
    : per_point_(per_point) {
  double square = 0;
  for (const double each : residual) square += each * each;
  const RestrictedLikelihood likelihood(residual, columns, per_point);
  constexpr double fewest_degrees = 4;
  if (!(likelihood.degrees() >= fewest_degrees) || !(square > 0) || residual.size() < 4 * per_point) return;
  const double white_variance = square / likelihood.degrees();
  const double white = likelihood.at(0).logarithm;

  // In Fisher's z = atanh r the likelihood is about normal, of width 1/sqrt(n) around its maximum.
  const double last = std::atanh(most_correlation);
  const auto logarithm_at = [&](double z) { return likelihood.at(std::tanh(z)).logarithm; };
  constexpr int coarse = 24, fine = 32;
  double best = 0, highest = white;
  for (int i = 1; i <= coarse; ++i) {
    const double z = last * i / coarse, here = logarithm_at(z);
    if (here > highest) {
      highest = here;
      best = z;
    }
  }
  const double reach = 5 / std::sqrt(static_cast<double>(residual.size())) + last / coarse;
  const double first = std::max(0.0, best - reach), step = (std::min(last, best + reach) - first) / fine;
  double total = 0;
  for (int i = 0; i < fine; ++i) {
    const double r = std::tanh(first + (i + 0.5) * step);
    const RestrictedLikelihood::Value value = likelihood.at(r);
    const double slab = (1 - r * r) * step / most_correlation;  // dr for dz
    const double weight = slab * std::exp(value.logarithm - highest);
    possibilities_.push_back({r, weight, value.innovation / (1 - r * r) / white_variance});
    total += weight;
  }
  const double white_weight = std::exp(white - highest);
  possibilities_.push_back({0, white_weight, 1});
  chance_ = total / (total + white_weight);
  for (Possibility& each : possibilities_) {
    each.probability /= total + white_weight;
    correlation_ += each.probability * each.correlation;
  }
}

double CorrelatedNoise::widening(const Eigen::VectorXd& unscaled) const {
  const double largest = unscaled.size() > 0 ? unscaled.lpNorm<Eigen::Infinity>() : 0;
  if (possibilities_.empty() || !(largest > 0)) return 1;
  // The size of the influence cancels; its squares would vanish or overflow for parameters of 1e-200 or 1e200.
  const Eigen::VectorXd influence = unscaled / largest;
  const double white = influence.squaredNorm();
  double variance = 0;
  for (const Possibility& each : possibilities_) {
    if (each.probability < 1e-6) continue;
    variance += each.probability * each.variance * variance_under(each.correlation, influence, per_point_);
  }
  return std::sqrt(variance / white);
}

}  // namespace frac::detail
