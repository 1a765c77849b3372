// SPDX-License-Identifier: BSD-3-Clause
#include "time_residuals.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/gram_schmidt.hpp"
#include "base/linear_algebra.hpp"
#include "base/median.hpp"
#include "loss.hpp"
#include "problem.hpp"

namespace frac::detail {

namespace {

std::vector<double> input_beyond_rest(const TimeResponseData& data) {
  std::vector<double> input = data.input();
  for (double& value : input) value -= data.input_at_rest();
  return input;
}

EventResponse from_rest(const TimeResponseData& data, const std::vector<std::size_t>& index) {
  std::vector<double> output_time;
  output_time.reserve(index.size());
  for (const std::size_t i : index) output_time.push_back(data.time()[i]);
  return {data.time(), input_beyond_rest(data), data.hold(), std::move(output_time)};
}

}  // namespace

std::shared_ptr<const PeriodicInput> periodic_input(const TimeResponseData& data) {
  if (data.hold() != Hold::band_limited) return nullptr;
  return std::make_shared<const PeriodicInput>(data.time(), input_beyond_rest(data));
}

RecordResponse::RecordResponse(const TimeResponseData& data, const std::vector<std::size_t>& index,
                               std::shared_ptr<const PeriodicInput> periodic)
    : response_(periodic ? std::variant<EventResponse, SteadyResponse>(SteadyResponse(std::move(periodic), index))
                         : std::variant<EventResponse, SteadyResponse>(from_rest(data, index))) {}

bool RecordResponse::evaluate(const TimeModel& model, double tolerance, EventResponse::Result& result) const {
  if (const auto* steady = std::get_if<SteadyResponse>(&response_)) {
    return std::visit([&](const auto& each) { return steady->evaluate(each, result); }, model);
  }
  return respond_to(model, std::get<EventResponse>(response_), tolerance, result);
}

std::vector<EventResponse> earlier_steps(const TimeResponseData& data, const std::vector<std::size_t>& index) {
  const double first = data.time().front(), length = data.time().back() - first;
  std::vector<double> output_time;
  output_time.reserve(index.size());
  for (const std::size_t i : index) output_time.push_back(data.time()[i]);
  std::vector<double> before{length / 8, length / 64};
  const bool input_changes =
      std::any_of(data.input().begin(), data.input().end(), [&](double each) { return each != data.input().front(); });
  if (input_changes) before.push_back(0);
  std::vector<EventResponse> steps;
  steps.reserve(before.size());
  for (const double each : before) {
    steps.emplace_back(std::vector{first - each, data.time().back()}, std::vector{1.0, 1.0}, Hold::zero_order,
                       output_time);
  }
  return steps;
}

TimeResiduals::TimeResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                             const Background& background, std::vector<std::size_t> index, double tolerance,
                             double unit, const Priors& priors, std::shared_ptr<const PeriodicInput> periodic)
    : Residuals(map),
      data_(data),
      structure_(structure),
      fixed_offset_(background.offset),
      trend_(background.trend),
      index_(std::move(index)),
      tolerance_(tolerance),
      whitening_(index_, background.noise_correlation),
      response_(data, index_, std::move(periodic)) {
  set_priors(priors, expected_noise);
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
  const double middle = average_.dot(output_);
  constexpr double out_of_proportion = 1e9;
  largest_model_ = fixed_offset_ ? std::numeric_limits<double>::infinity()
                                 : out_of_proportion * (output_.array() - middle).abs().maxCoeff();
  fixed_columns_.resize(count, (fixed_offset_ ? 0 : 1) + (trend_ ? 1 : 0));
  if (!fixed_offset_) fixed_columns_.col(0) = weight_;
  if (trend_) {
    for (Eigen::Index i = 0; i < count; ++i) {
      const double since = data.time()[index_[static_cast<std::size_t>(i)]] - data.time().front();
      fixed_columns_(i, fixed_columns_.cols() - 1) = weight_[i] * since;
    }
  }
  whiten(fixed_columns_);
  if (background.earlier_input) earlier_ = earlier_steps(data, index_);
  earlier_model_.resize(earlier_.size());
}

bool TimeResiduals::simulate(std::span<const double> theta) const {
  if (theta_ && std::equal(theta.begin(), theta.end(), theta_->begin(), theta_->end())) return true;
  theta_.reset();
  const std::optional<TimeModel> model = time_model_if_any(structure_, map().to_user(theta));
  if (!model || !response_.evaluate(*model, tolerance_, model_)) return false;
  if (!(model_.value.cwiseAbs().maxCoeff() <= largest_model_)) return false;
  for (std::size_t k = 0; k < earlier_.size(); ++k) {
    if (!respond_to(*model, earlier_[k], tolerance_, earlier_model_[k])) return false;
  }
  theta_.emplace(theta.begin(), theta.end());
  return true;
}

bool TimeResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  if (!simulate(theta)) return false;
  Eigen::VectorXd rest = model_.value - output_;
  if (eliminated() > 0 && !only_offset()) {
    rest = without_background(model_.value);
    const Eigen::MatrixXd columns = eliminated_columns();
    const Eigen::VectorXd coefficient = coefficients(columns, rest);
    Eigen::Map<Eigen::VectorXd>(residual, rest.size()) = rest + columns * coefficient;
    if (!jacobian) return true;
    Eigen::Map<Eigen::MatrixXd> by_theta(jacobian, rest.size(), static_cast<Eigen::Index>(map().free().size()));
    by_theta = weighted_gradient(coefficient) * map().jacobian(map().to_user(theta));
    remove_span(PivotedQr(columns).basis(), by_theta);
    return by_theta.allFinite();
  }
  rest.array() += fixed_offset_ ? *fixed_offset_ : -location(rest);
  rest.array() *= weight_.array();
  whiten(rest);
  Eigen::Map<Eigen::VectorXd>(residual, rest.size()) = rest;
  if (!jacobian) return true;
  Eigen::Map<Eigen::MatrixXd> by_theta(jacobian, rest.size(), static_cast<Eigen::Index>(map().free().size()));
  by_theta.setZero();
  for (const ParameterMap::Entry& entry : map().jacobian_entries(map().to_user(theta))) {
    by_theta.col(static_cast<Eigen::Index>(entry.free)) +=
        entry.derivative * model_.gradient.col(static_cast<Eigen::Index>(entry.parameter));
  }
  if (!fixed_offset_) {
    // Under a robust loss the offset moves a little otherwise, but the loss does not mind: it is least there, so that
    // its gradient is that of these rows.
    const Eigen::RowVectorXd mean = average_.transpose() * by_theta;
    by_theta.rowwise() -= mean;
  }
  by_theta.array().colwise() *= weight_.array();
  whiten(by_theta);
  return by_theta.allFinite();
}

void TimeResiduals::whiten(Eigen::Ref<Eigen::MatrixXd> columns) const {
  for (Eigen::Index k = 0; k < columns.cols(); ++k)
    whitening_.apply({columns.col(k).data(), static_cast<std::size_t>(columns.rows())});
}

Eigen::VectorXd TimeResiduals::without_background(const Eigen::VectorXd& model) const {
  Eigen::VectorXd rest = model - output_;
  if (fixed_offset_) rest.array() += *fixed_offset_;
  rest.array() *= weight_.array();
  whiten(rest);
  return rest;
}

Eigen::MatrixXd TimeResiduals::eliminated_columns() const {
  Eigen::MatrixXd columns(weight_.size(), static_cast<Eigen::Index>(eliminated()));
  columns.leftCols(fixed_columns_.cols()) = fixed_columns_;
  for (std::size_t k = 0; k < earlier_.size(); ++k) {
    columns.col(fixed_columns_.cols() + static_cast<Eigen::Index>(k)) =
        weight_.array() * earlier_model_[k].value.array();
  }
  whiten(columns.rightCols(static_cast<Eigen::Index>(earlier_.size())));
  return columns;
}

Eigen::MatrixXd TimeResiduals::weighted_gradient(const Eigen::VectorXd& coefficient) const {
  Eigen::MatrixXd gradient = model_.gradient;
  for (std::size_t k = 0; k < earlier_.size(); ++k) {
    gradient += coefficient[fixed_columns_.cols() + static_cast<Eigen::Index>(k)] * earlier_model_[k].gradient;
  }
  gradient.array().colwise() *= weight_.array();
  whiten(gradient);
  return gradient;
}

Eigen::VectorXd TimeResiduals::coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual) const {
  Eigen::VectorXd found = -PivotedQr(columns).solve(residual);
  if (loss_ == Loss::none) return found;
  // Reweighted least squares: each is nearer than the last, by the share of outliers at least.
  for (int pass = 0; pass < 200; ++pass) {
    const Eigen::VectorXd rest = residual + columns * found;
    Eigen::VectorXd root(rest.size());
    for (Eigen::Index i = 0; i < rest.size(); ++i) {
      const double x = rest[i] / loss_scale_;
      root[i] = std::sqrt(x != 0 ? loss_at(loss_, x).psi / x : 1);
    }
    const Eigen::VectorXd next =
        -PivotedQr(root.asDiagonal() * columns).solve(Eigen::VectorXd(root.asDiagonal() * residual));
    const bool converged = (columns * (next - found)).norm() <= 1e-14 * (columns * found).norm();
    found = next;
    if (converged) break;
  }
  return found;
}

void TimeResiduals::set_loss(Loss loss, double scale) {
  loss_ = loss;
  loss_scale_ = scale;
}

double TimeResiduals::location(const Eigen::VectorXd& values) const {
  if (loss_ == Loss::none) return average_.dot(values);
  double centre = median({values.begin(), values.end()});
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

Residuals::BestFactor TimeResiduals::best_factor(std::span<const double> theta) const {
  if (!simulate(theta)) return {};
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
  if (!(factor > 0 && std::isfinite(factor))) return {};
  return {factor};
}

double TimeResiduals::rounding_cost() const noexcept {
  return static_cast<double>(count()) * std::max(1e-28, tolerance_ * tolerance_);
}

TimeResiduals::Eliminated TimeResiduals::eliminated_at(std::span<const double> theta) const {
  if (eliminated() == 0 || !simulate(theta)) return {};
  Eliminated result;
  if (only_offset()) {
    result.coefficient = Eigen::VectorXd::Constant(1, location(output_ - model_.value));
  } else {
    result.coefficient = coefficients(eliminated_columns(), without_background(model_.value));
  }
  result.gradient = weighted_gradient(result.coefficient);
  return result;
}

Eigen::MatrixXd TimeResiduals::possible_background(std::span<const double> theta) const {
  const std::optional<TimeModel> model = time_model_if_any(structure_, map().to_user(theta));
  const std::vector<EventResponse> steps = earlier_steps(data_, index_);
  Eigen::MatrixXd columns(weight_.size(), 1 + static_cast<Eigen::Index>(steps.size()));
  for (Eigen::Index i = 0; i < weight_.size(); ++i) {
    columns(i, 0) = weight_[i] * (data_.time()[index_[static_cast<std::size_t>(i)]] - data_.time().front());
  }
  for (std::size_t k = 0; k < steps.size(); ++k) {
    EventResponse::Result response;
    if (!model || !respond_to(*model, steps[k], tolerance_, response)) return {};
    columns.col(static_cast<Eigen::Index>(k) + 1) = weight_.array() * response.value.array();
  }
  whiten(columns);
  return columns;
}

std::vector<double> TimeResiduals::without_response() const {
  Eigen::VectorXd rest = without_background(Eigen::VectorXd::Zero(output_.size()));
  if (fixed_columns_.cols() > 0) rest += fixed_columns_ * coefficients(fixed_columns_, rest);
  return {rest.begin(), rest.end()};
}

}  // namespace frac::detail
