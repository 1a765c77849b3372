// SPDX-License-Identifier: BSD-3-Clause
#include "time_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "loss.hpp"

namespace frac::detail {

EventResponse event_response(const TimeResponseData& data, const std::vector<std::size_t>& index) {
  std::vector<double> input = data.input();
  for (double& value : input) value -= data.input_at_rest();
  std::vector<double> output_time;
  output_time.reserve(index.size());
  for (const std::size_t i : index) output_time.push_back(data.time()[i]);
  return {data.time(), std::move(input), data.hold(), std::move(output_time)};
}

std::optional<RatioOfPowerSums> ratio_at(const Structure& structure, std::span<const double> parameters) {
  try {
    return reduce(structure.expression(), parameters, Sensitivity::all);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

TimeResiduals::TimeResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                             std::optional<double> offset, std::vector<std::size_t> index, double tolerance,
                             double unit)
    : Residuals(map),
      data_(data),
      structure_(structure),
      fixed_offset_(offset),
      index_(std::move(index)),
      tolerance_(tolerance),
      events_(event_response(data, index_)) {
  const auto count = static_cast<Eigen::Index>(index_.size());
  weight_.resize(count);
  output_.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t point = index_[static_cast<std::size_t>(i)];
    output_[i] = data.output()[point];
    weight_[i] = 1 / (unit * (data.sigma().empty() ? 1 : data.sigma()[point]));
  }
  average_ = weight_.array().square();
  average_ /= average_.sum();
}

bool TimeResiduals::simulate(std::span<const double> theta) const {
  if (theta_ && std::equal(theta.begin(), theta.end(), theta_->begin(), theta_->end())) return true;
  theta_.reset();
  const std::optional<RatioOfPowerSums> ratio = ratio_at(structure_, map().to_user(theta));
  if (!ratio || !events_.evaluate(*ratio, tolerance_, model_)) return false;
  theta_.emplace(theta.begin(), theta.end());
  return true;
}

bool TimeResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  if (!simulate(theta)) return false;
  Eigen::VectorXd rest = model_.value - output_;
  rest.array() += fixed_offset_ ? *fixed_offset_ : -location(rest);
  rest.array() *= weight_.array();
  Eigen::Map<Eigen::VectorXd>(residual, rest.size()) = rest;
  if (!jacobian) return true;
  Eigen::Map<Eigen::MatrixXd> by_theta(jacobian, rest.size(), static_cast<Eigen::Index>(map().free().size()));
  by_theta = model_.gradient.lazyProduct(map().jacobian(map().to_user(theta)));
  if (!fixed_offset_) {
    // Under a robust loss the offset moves a little otherwise, but the loss does not mind: it is least there, so that
    // its gradient is that of these rows.
    const Eigen::RowVectorXd mean = average_.transpose() * by_theta;
    by_theta.rowwise() -= mean;
  }
  by_theta.array().colwise() *= weight_.array();
  return by_theta.allFinite();
}

Eigen::MatrixXd TimeResiduals::eliminated_columns() const {
  return fixed_offset_ ? Eigen::MatrixXd(weight_.size(), 0) : Eigen::MatrixXd(weight_);
}

void TimeResiduals::set_loss(Loss loss, double scale) {
  loss_ = loss;
  loss_scale_ = scale;
}

double TimeResiduals::location(const Eigen::VectorXd& values) const {
  if (loss_ == Loss::none) return average_.dot(values);
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  double centre = *middle;
  const double negligible = 1e-15 * loss_scale_ / weight_.maxCoeff();
  // Reweighted means: each is nearer than the last, by the share of outliers at least.
  for (int pass = 0; pass < 200; ++pass) {
    double sum = 0, weights = 0;
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      const double x = (values[i] - centre) * weight_[i] / loss_scale_;
      const double weight = average_[i] * (x != 0 ? loss_at(loss_, x).psi / x : 1);
      sum += weight * (values[i] - centre);
      weights += weight;
    }
    const double step = sum / weights;
    centre += step;
    if (!(std::abs(step) > negligible + 1e-15 * std::abs(centre))) break;
  }
  return centre;
}

double TimeResiduals::best_factor(std::span<const double> theta) const {
  if (!simulate(theta)) return 1;
  Eigen::VectorXd model = model_.value;
  Eigen::VectorXd target = output_;
  if (fixed_offset_) {
    target.array() -= *fixed_offset_;
  } else {
    model.array() -= average_.dot(model);
    target.array() -= average_.dot(target);
  }
  const double factor =
      (average_.array() * model.array() * target.array()).sum() / (average_.array() * model.array().square()).sum();
  return factor > 0 && std::isfinite(factor) ? factor : 1;
}

double TimeResiduals::rounding_cost() const noexcept {
  return static_cast<double>(count()) * std::max(1e-28, tolerance_ * tolerance_);
}

TimeResiduals::Offset TimeResiduals::offset(std::span<const double> theta) const {
  if (fixed_offset_ || !simulate(theta)) return {fixed_offset_.value_or(0), {}};
  return {location(output_ - model_.value), model_.gradient.transpose() * average_};
}

std::vector<double> TimeResiduals::without_response() const {
  const double offset = fixed_offset_ ? *fixed_offset_ : location(output_);
  const Eigen::VectorXd rest = (offset - output_.array()) * weight_.array();
  return {rest.begin(), rest.end()};
}

}  // namespace frac::detail
