// SPDX-License-Identifier: BSD-3-Clause
#include "joint_confidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/residuals/loss.hpp"
#include "identification/statistics/correlated_noise.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// A column this much smaller than the largest is rounding: the residuals do not see the variable.
constexpr double unseen_column = 1e-10;

bool is_at_bound(const JointVariable& variable, double value) {
  const double margin = 1e-6 * std::min(1.0, variable.upper - variable.lower);
  return value - variable.lower <= margin || variable.upper - value <= margin;
}

/// One curve at the minimum.  With own columns A and shared columns B of the Jacobian the own variables follow the
/// shared ones by -A^+ B, and what the curve knows of the shared ones stands in the part of B outside the space of A.
struct Curve {
  std::vector<Eigen::Index> inner;  // own variables that are seen and not at a bound
  Eigen::VectorXd residual;
  Eigen::MatrixXd own_influence;  // what an own variable moves by for each residual, the shared ones held
  Eigen::MatrixXd follows;        // d own / d shared
  Eigen::MatrixXd rest;           // of the shared columns
  CorrelatedNoise noise;
};

/// Inverse of a symmetric matrix with unit diagonal, and its condition.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& matrix, double& condition) {
  const auto [values, vectors] = right_singular_vectors(matrix);
  const double smallest = std::numeric_limits<double>::epsilon() * values[0];
  condition = values[0] / std::max(values[values.size() - 1], smallest);
  return vectors * values.cwiseMax(smallest).cwiseInverse().asDiagonal() * vectors.transpose();
}

/// Residuals under a loss, all curves together: the variance of one, and the unit of the loss, each times the degrees
/// of freedom (Huber 1981, sect. 7.6); and, in place of the residuals, what they pull with.
struct Pulls {
  double variance, loss_unit;
  double slope;  // mean of psi'
  std::vector<Eigen::VectorXd> residual;
};
Pulls pulls_of(const std::vector<CurveResiduals>& curves, const std::vector<Curve>& at) {
  Pulls pulls{0, 0, 0, {}};
  double count = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const double scale = curves[c].loss_scale();
    Eigen::VectorXd& pull = pulls.residual.emplace_back(at[c].residual);
    for (std::size_t row = 0; row < curves[c].count(); ++row) {
      double& each = pull[static_cast<Eigen::Index>(row)];
      const LossAt loss = loss_at(curves[c].loss(), each / scale);
      each = loss.psi * scale;
      pulls.variance += each * each;
      pulls.slope += loss.slope;
      ++count;
    }
  }
  pulls.slope /= count;
  pulls.loss_unit = pulls.variance / pulls.slope;
  pulls.variance /= pulls.slope * pulls.slope;
  return pulls;
}

/// How correlated neighbours enlarge the errors of variables, given what a curve adds to each.
class Widening {
 public:
  explicit Widening(Eigen::Index count) : white_(Eigen::VectorXd::Zero(count)), wide_(white_) {}
  /// @param influence  of the residuals, and behind these of priors, which no noise correlates
  void add(const Eigen::MatrixXd& influence, const CorrelatedNoise& noise, std::size_t residuals) {
    const auto rows = static_cast<Eigen::Index>(residuals);
    for (Eigen::Index k = 0; k < influence.cols(); ++k) {
      const Eigen::VectorXd of_residuals = influence.col(k).head(rows);
      const double square = of_residuals.squaredNorm(), factor = noise.widening(of_residuals);
      white_[k] += square;
      wide_[k] += square * factor * factor;
    }
    add_priors(influence.bottomRows(influence.rows() - rows));
  }
  void add_priors(const Eigen::MatrixXd& influence) {
    const Eigen::VectorXd squares = influence.colwise().squaredNorm().transpose();
    white_ += squares;
    wide_ += squares;
  }
  [[nodiscard]] Eigen::VectorXd factors() const {
    return (white_.array() > 0).select((wide_.array() / white_.array()).sqrt(), 1.0);
  }

 private:
  Eigen::VectorXd white_, wide_;
};

}  // namespace

JointConfidence joint_confidence(std::vector<CurveResiduals>& curves, const JointLayout& layout,
                                 const JointPoint& point) {
  const auto own = static_cast<Eigen::Index>(layout.own.size()),
             shared = static_cast<Eigen::Index>(layout.shared.size());
  JointConfidence result{};
  result.shared = Eigen::MatrixXd::Constant(shared, shared, nan);
  result.curve.assign(curves.size(), Eigen::MatrixXd::Constant(own + shared, own + shared, nan));
  result.shared_widening.assign(layout.shared.size(), 1.0);
  result.own_widening.assign(curves.size(), std::vector<double>(layout.own.size(), 1.0));
  result.own_at_bound.assign(curves.size(), std::vector<bool>(layout.own.size(), false));

  std::vector<Eigen::MatrixXd> jacobian;
  std::vector<Curve> at(curves.size());
  Eigen::VectorXd size = Eigen::VectorXd::Zero(shared);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const auto rows = static_cast<Eigen::Index>(curves[c].rows());
    jacobian.emplace_back(rows, own + shared);
    at[c].residual.resize(rows);
    curves[c].evaluate(point.shared, point.own[c], at[c].residual.data(), jacobian[c].data());
    size += jacobian[c].rightCols(shared).colwise().squaredNorm().transpose();
  }
  const Pulls pulls = pulls_of(curves, at);
  // The cost weighs priors by the unit of the loss; squares of residuals weigh by their variance.
  const double prior_weight = curves.front().prior_weight() * std::sqrt(1 / pulls.slope);
  Eigen::MatrixXd shared_priors(static_cast<Eigen::Index>(layout.shared_priors.size()), shared);
  for (Eigen::Index row = 0; row < shared_priors.rows(); ++row) {
    const JointLayout::Pull pull =
        layout.pull(layout.shared_priors[static_cast<std::size_t>(row)], point.shared, point.own.front(), 0);
    for (Eigen::Index k = 0; k < shared; ++k)
      shared_priors(row, k) = prior_weight * pull.by_variable[static_cast<std::size_t>(own + k)];
  }
  size += shared_priors.colwise().squaredNorm().transpose();
  for (std::size_t c = 0; c < curves.size(); ++c) {
    jacobian[c].bottomRows(static_cast<Eigen::Index>(layout.own_priors.size())) *=
        prior_weight / curves[c].prior_weight();
  }
  size = size.cwiseSqrt();

  std::vector<Eigen::Index> inner;
  for (Eigen::Index k = 0; k < shared; ++k) {
    const auto index = static_cast<std::size_t>(k);
    result.shared_at_bound.push_back(is_at_bound(layout.shared[index], point.shared[index]));
    if (result.shared_at_bound.back()) {
      ++result.rank;
    } else if (size[k] > unseen_column * size.maxCoeff()) {
      inner.push_back(k);
    }
  }
  const auto width = static_cast<Eigen::Index>(inner.size());
  result.rank += inner.size();
  shared_priors = Eigen::MatrixXd(shared_priors(Eigen::all, inner));
  Eigen::MatrixXd known = shared_priors.transpose() * shared_priors;
  const auto own_priors = static_cast<Eigen::Index>(layout.own_priors.size());
  std::size_t residuals = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    Curve& curve = at[c];
    residuals += curves[c].count();
    const Eigen::VectorXd norm = jacobian[c].leftCols(own).colwise().norm();
    for (Eigen::Index k = 0; k < own; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const bool at_bound = is_at_bound(layout.own[index], point.own[c][index]);
      result.own_at_bound[c][index] = at_bound;
      if (at_bound)
        ++result.rank;
      else if (norm[k] > unseen_column * norm.maxCoeff())
        curve.inner.push_back(k);
    }
    result.rank += curve.inner.size();
    curve.rest = jacobian[c].rightCols(shared)(Eigen::all, inner);
    Eigen::MatrixXd fitted = curve.rest;
    curve.follows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(curve.inner.size()), width);
    curve.own_influence = Eigen::MatrixXd::Zero(fitted.rows(), curve.follows.rows());
    if (!curve.inner.empty()) {
      Eigen::MatrixXd columns = jacobian[c](Eigen::all, curve.inner);
      const Eigen::VectorXd scale = columns.colwise().norm().transpose();
      columns = columns * scale.cwiseInverse().asDiagonal();
      const PlainQr qr(columns);
      const Eigen::MatrixXd basis = qr.basis();
      result.from_priors += basis.bottomRows(own_priors).squaredNorm();
      curve.own_influence = qr.dual() * scale.cwiseInverse().asDiagonal();
      curve.follows = -curve.own_influence.transpose() * curve.rest;
      remove_span(basis, curve.rest);
      fitted.conservativeResize(Eigen::NoChange, width + columns.cols());
      fitted.rightCols(columns.cols()) = columns;
    }
    known += curve.rest.transpose() * curve.rest;
    const Eigen::VectorXd scale = fitted.colwise().norm().transpose();
    for (Eigen::Index k = 0; k < fitted.cols(); ++k)
      if (scale[k] > 0) fitted.col(k) /= scale[k];
    // What is left of the residuals once the curve is fitted alone: the noise without what sharing adds.
    const auto count = static_cast<Eigen::Index>(curves[c].count());
    fitted = Eigen::MatrixXd(fitted.topRows(count));
    Eigen::MatrixXd alone = pulls.residual[c].head(count);
    remove_span(PivotedQr(fitted).basis(), alone);
    const Eigen::VectorXd left = alone.col(0);
    curve.noise = {std::span(left.data(), curves[c].count()), fitted, curves[c].per_point()};
    result.noise_correlation += curve.noise.correlation() / static_cast<double>(curves.size());
  }

  result.condition = 1;
  Eigen::MatrixXd covariance = known;
  if (width > 0) {
    const Eigen::VectorXd scale =
        known.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min()).cwiseInverse();
    covariance = scale.asDiagonal() * inverse_of(scale.asDiagonal() * known * scale.asDiagonal(), result.condition) *
                 scale.asDiagonal();
  }
  result.from_priors += (shared_priors * covariance).cwiseProduct(shared_priors).sum();
  for (const Curve& curve : at) {
    const Eigen::MatrixXd rows = curve.rest.bottomRows(own_priors);
    result.from_priors += (rows * covariance).cwiseProduct(rows).sum();
  }
  const double degrees = static_cast<double>(residuals) - static_cast<double>(result.rank) + result.from_priors;
  result.half_width = student_t_95(degrees);
  result.deviation = degrees > 0 ? std::sqrt(pulls.variance / degrees) : nan;
  result.loss_unit = degrees > 0 ? pulls.loss_unit / degrees : nan;
  const double variance = result.deviation * result.deviation;
  Widening widening(width);
  for (std::size_t c = 0; c < at.size(); ++c) widening.add(at[c].rest * covariance, at[c].noise, curves[c].count());
  widening.add_priors(shared_priors * covariance);
  const Eigen::VectorXd factors = widening.factors();
  const Eigen::MatrixXd white = variance * covariance;
  covariance = factors.asDiagonal() * white * factors.asDiagonal();
  for (Eigen::Index k = 0; k < width; ++k)
    result.shared_widening[static_cast<std::size_t>(inner[static_cast<std::size_t>(k)])] = factors[k];
  result.shared(inner, inner) = covariance;

  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Curve& curve = at[c];
    Widening local(curve.own_influence.cols());
    local.add(curve.own_influence, curve.noise, curves[c].count());
    const Eigen::VectorXd own_factors = local.factors();
    // Errors with the shared variables held, and those that these bring along, have nothing to do with each other.
    const Eigen::MatrixXd held = variance * own_factors.asDiagonal() *
                                 (curve.own_influence.transpose() * curve.own_influence) * own_factors.asDiagonal();
    const Eigen::MatrixXd mixed = curve.follows * covariance;
    const Eigen::MatrixXd carried = mixed * curve.follows.transpose();
    const Eigen::MatrixXd carried_in_white_noise = curve.follows * white * curve.follows.transpose();
    std::vector<Eigen::Index> places;
    for (const Eigen::Index k : inner) places.push_back(own + k);
    Eigen::MatrixXd& all = result.curve[c];
    all(places, places) = covariance;
    all(curve.inner, curve.inner) = held + carried;
    all(curve.inner, places) = mixed;
    all(places, curve.inner) = mixed.transpose();
    for (std::size_t k = 0; k < curve.inner.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double in_white_noise = held(i, i) / (own_factors[i] * own_factors[i]) + carried_in_white_noise(i, i);
      result.own_widening[c][static_cast<std::size_t>(curve.inner[k])] =
          in_white_noise > 0 ? std::sqrt((held(i, i) + carried(i, i)) / in_white_noise) : 1;
    }
  }
  return result;
}

}  // namespace frac::detail
