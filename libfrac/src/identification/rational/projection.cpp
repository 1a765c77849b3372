// SPDX-License-Identifier: BSD-3-Clause
#include "projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/wide_vectors.hpp"
#include "frac/cancellation.hpp"
#include "identification/statistics/first_order_likelihood.hpp"
#include "identification/statistics/information.hpp"

namespace frac::detail {

using Complex = std::complex<double>;
using Index = Eigen::Index;

namespace {

/// Whether squares have neither overflowed nor vanished: the weights of data of 1e-200 are 1e200.
bool is_in_range(double length) {
  return length >= 1e-100 && length <= 1e100;
}

/// The least-squares slope of ln|value| over ln omega at the upper end.
double slope_at_end(const std::vector<double>& log_omega, const Eigen::VectorXcd& value) {
  const double half_decade = std::log(10.0) / 2;
  const auto within = std::lower_bound(log_omega.begin(), log_omega.end(), log_omega.back() - half_decade);
  const Index count = std::min(value.size(), std::max<Index>(3, log_omega.end() - within));
  const Eigen::ArrayXd size = value.tail(count).cwiseAbs().array().log();
  const Eigen::ArrayXd at = Eigen::Map<const Eigen::ArrayXd>(log_omega.data(), value.size()).tail(count);
  const Eigen::ArrayXd about = at - at.mean();
  return (about * size).sum() / about.square().sum();
}

/// The way to the least linearised cost by some of the parameters: the solution x of (part + least) x = -slope, by
/// L D L'.
void solve_part(const NormalEquations& normal, const Eigen::VectorXd& slope, const std::vector<Index>& parameters,
                double least, std::vector<double>& x) {
  const std::size_t count = parameters.size();
  thread_local std::vector<double> factor, pivot;
  factor.resize(count * count);
  pivot.resize(count);
  x.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    double* const row = factor.data() + i * count;
    double diagonal = normal.matrix(parameters[i], parameters[i]) + least, right = -slope[parameters[i]];
    for (std::size_t j = 0; j < i; ++j) {
      double product = normal.matrix(parameters[i], parameters[j]);
      for (std::size_t k = 0; k < j; ++k) product -= row[k] * factor[j * count + k];
      row[j] = product;  // of L D, until the row is complete
    }
    for (std::size_t j = 0; j < i; ++j) {
      const double lower = row[j] / pivot[j];
      diagonal -= lower * row[j];
      right -= lower * x[j];
      row[j] = lower;
    }
    pivot[i] = std::max(diagonal, least);
    x[i] = right;
  }
  for (std::size_t i = count; i-- > 0;) {
    x[i] /= pivot[i];
    for (std::size_t j = i + 1; j < count; ++j) x[i] -= factor[j * count + i] * x[j];
  }
}

}  // namespace

void RecordRows::put(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Ref<Eigen::VectorXd> column) const {
  column = weight.cwiseProduct(values);
  whitening.apply({column.data(), static_cast<std::size_t>(column.size())});
  if (background.cols() > 0) remove_span(background, column);
}

ProjectedData::ProjectedData(const FrequencyResponseData& data, const ResidualRule& rule) : form_(rule.form) {
  take_band(data.omega());
  const auto points = static_cast<Index>(data.size());
  weight_ = Eigen::Map<const Eigen::VectorXd>(rule.weight.data(), points);
  const Eigen::VectorXcd value = Eigen::Map<const Eigen::VectorXcd>(data.value().data(), points);
  end_slope_ = slope_at_end(log_omega_, value);
  target_.resize(form_ == ResidualForm::cartesian ? 2 * points : points);
  put(value, target_);
}

ProjectedData::ProjectedData(RecordRows record)
    : record_(std::move(record)), form_(ResidualForm::cartesian), end_slope_(-std::numeric_limits<double>::infinity()) {
  const Index count = std::max<Index>(16, record_->time.size() / 2);
  const Eigen::ArrayXd log_omega = Eigen::ArrayXd::LinSpaced(count, std::log(record_->slow), std::log(record_->fast));
  const Eigen::VectorXd omega = log_omega.exp();
  take_band({omega.begin(), omega.end()});
  target_.resize(record_->output.size());
  record_->put(record_->output, target_);
}

void ProjectedData::take_band(const std::vector<double>& omega) {
  centre_ = std::sqrt(omega.front()) * std::sqrt(omega.back());
  log_lower_ = std::log(omega.front() / centre_);
  const auto count = static_cast<Index>(omega.size());
  s_.resize(count);
  log_s_.resize(count);
  for (Index i = 0; i < count; ++i) {
    const double scaled = omega[static_cast<std::size_t>(i)] / centre_;
    log_omega_.push_back(std::log(scaled));
    s_[i] = Complex(0, scaled);
    log_s_[i] = Complex(log_omega_.back(), std::numbers::pi / 2);
  }
  const Eigen::VectorXd scaled = s_.imag();
  grid_.prepare({scaled.data(), omega.size()});
}

void ProjectedData::put(const Eigen::Ref<const Eigen::VectorXcd>& values, Eigen::Ref<Eigen::VectorXd> column) const {
  if (record_) {
    record_->put(values.real(), column);
    return;
  }
  thread_local std::vector<double> unseen;
  unseen.resize(static_cast<std::size_t>(values.size()));
  put(values.data(), column.data(), unseen.data());
}

void ProjectedData::put(const Complex* values, double* seen, double* unseen) const {
  const auto* const parts = reinterpret_cast<const double*>(values);
  const Index points = weight_.size();
  const double* const weight = weight_.data();
  double* const re = form_ == ResidualForm::imaginary ? unseen : seen;
  double* const im = form_ == ResidualForm::imaginary ? seen : form_ == ResidualForm::real ? unseen : seen + points;
  with_wide_vectors([&]() FRACFIT_INLINE {
    for (Index i = 0; i < points; ++i) {
      re[i] = weight[i] * parts[2 * i];
      im[i] = weight[i] * parts[2 * i + 1];
    }
  });
}

Eigen::ArrayXcd ProjectedData::power(double order, double shift) const {
  Eigen::ArrayXd size(s_.size());
  grid_.powers(order, 0, {size.data(), static_cast<std::size_t>(size.size())});
  const Complex factor = std::polar(std::exp(order * shift), order * std::numbers::pi / 2);
  Eigen::ArrayXcd values(size.size());
  for (Index i = 0; i < size.size(); ++i) values[i] = {size[i] * factor.real(), size[i] * factor.imag()};
  return values;
}

Eigen::ArrayXcd ProjectedData::delayed(double time) const {
  return s_.array().unaryExpr([time](Complex s) { return std::polar(1.0, -time * s.imag()); });
}

std::optional<ProjectedData::Weighted> ProjectedData::weighted(const Eigen::MatrixXcd& columns) const {
  Eigen::MatrixXd matrix(target_.size(), columns.cols());
  Eigen::VectorXd length(columns.cols()), unseen(weight_.size());
  const auto length_of = [](const auto& column) {
    const double fast = column.norm();
    return is_in_range(fast) ? fast : column.stableNorm();
  };
  for (Index k = 0; k < columns.cols(); ++k) {
    if (record_)
      record_->put(columns.col(k).real(), matrix.col(k));
    else
      put(columns.col(k).data(), matrix.col(k).data(), unseen.data());
    length[k] = length_of(matrix.col(k));
    const double whole = one_part() ? std::hypot(length[k], length_of(unseen)) : length[k];
    if (!std::isfinite(whole)) return std::nullopt;
    // A column that is rounding beside the whole complex one is one that the fitted part is blind to.
    if (length[k] > 1e-12 * whole) {
      matrix.col(k) *= 1 / length[k];
    } else {
      matrix.col(k).setZero();
      length[k] = 1;
    }
  }
  return Weighted{std::move(matrix), std::move(length)};
}

std::optional<ProjectedData::Projection> ProjectedData::project(const Eigen::MatrixXcd& columns) const {
  throw_if_cancelled();
  if (columns.cols() > target_.size()) return std::nullopt;
  std::optional<Weighted> seen = weighted(columns);
  if (!seen) return std::nullopt;
  Orthonormalised apart = orthonormalised(std::move(seen->matrix), target_, 1e-11);
  if (apart.basis.cols() == 0) return std::nullopt;
  const double cost = apart.rest.squaredNorm();
  if (!std::isfinite(cost)) return std::nullopt;
  return Projection{std::move(apart), std::move(seen->length), cost};
}

bool ProjectedData::complete(Eigen::MatrixXcd columns, Projection&& projection, Linear& linear) const {
  linear.coefficients = projection.columns.solution().cwiseQuotient(projection.length);
  linear.model = columns * linear.coefficients.cast<Complex>();
  linear.orthonormal = std::move(projection.columns.basis);
  linear.residual = -projection.columns.rest;
  linear.cost = projection.cost;
  linear.columns = std::move(columns);
  return linear.model.allFinite();
}

bool ProjectedData::solve(Eigen::MatrixXcd columns, Linear& linear) const {
  if (columns.cols() == 0) {
    linear = {
        Eigen::MatrixXd(target_.size(), 0), -target_, Eigen::VectorXcd::Zero(s_.size()), {}, columns, data_power()};
    return true;
  }
  std::optional<Projection> projection = project(columns);
  return projection && complete(std::move(columns), std::move(*projection), linear);
}

double ProjectedData::cost_with(const Linear& linear, const Eigen::MatrixXcd& further) const {
  throw_if_cancelled();
  std::optional<Weighted> seen = weighted(further);
  if (!seen) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd& matrix = seen->matrix;
  // The second time takes what rounding of the first has left.
  for (int pass = 0; pass < 2; ++pass) remove_span(linear.orthonormal, matrix);
  Eigen::VectorXd residual = linear.residual;
  for (Index k = 0; k < matrix.cols(); ++k) {
    auto column = matrix.col(k);
    for (Index before = 0; before < k; ++before) column -= matrix.col(before) * matrix.col(before).dot(column);
    const double length = column.norm();
    constexpr double rounding = 1e-11;
    column *= length > rounding ? 1 / length : 0;
    residual -= column * column.dot(residual);
  }
  return residual.squaredNorm();
}

NormalEquations ProjectedData::normal_equations(const Eigen::MatrixXcd& derivatives, const Linear& linear) const {
  Eigen::MatrixXd jacobian(linear.residual.size(), derivatives.cols());
  for (Index k = 0; k < derivatives.cols(); ++k) put(derivatives.col(k), jacobian.col(k));
  remove_span(linear.orthonormal, jacobian);
  return {products_of(jacobian), jacobian.transpose() * linear.residual};
}

// From 0 towards the least cost as far as the first bound, on along it, and off bounds that hold back no longer: each
// part of the way lowers the cost (the primal method of active sets).
Eigen::VectorXd NormalEquations::step(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) const {
  const Index count = gradient.size();
  const double least = 1e-14 * matrix.diagonal().maxCoeff() + std::numeric_limits<double>::min();
  Eigen::VectorXd step = Eigen::VectorXd::Zero(count);
  std::vector<Index> free, held;
  free.reserve(static_cast<std::size_t>(count));
  held.reserve(static_cast<std::size_t>(count));
  for (Index k = 0; k < count; ++k) {
    if (lower[k] < upper[k]) free.push_back(k);
  }
  std::vector<double> way;
  Eigen::VectorXd now = gradient;  // after the step
  for (Index round = 0; round < 3 * count && !free.empty(); ++round) {
    solve_part(*this, now, free, least, way);
    double share = 1;
    std::size_t first = free.size();
    for (std::size_t i = 0; i < free.size(); ++i) {
      const Index k = free[i];
      const double along = way[i], room = (along > 0 ? upper[k] : lower[k]) - step[k];
      if (std::abs(along) * share <= std::abs(room)) continue;
      share = room / along;
      first = i;
    }
    for (std::size_t i = 0; i < free.size(); ++i) step[free[i]] += share * way[i];
    const bool meets_bound = first < free.size();
    if (meets_bound) {
      step[free[first]] = way[first] > 0 ? upper[free[first]] : lower[free[first]];
      held.push_back(free[first]);
      free.erase(free.begin() + static_cast<std::ptrdiff_t>(first));
    }
    now.noalias() = matrix * step;
    now += gradient;
    if (meets_bound && !free.empty()) continue;
    // Which bound holds back most?
    const auto pull = [&](Index k) { return step[k] == upper[k] ? now[k] : -now[k]; };
    const auto most = std::max_element(held.begin(), held.end(), [&](Index a, Index b) { return pull(a) < pull(b); });
    if (most == held.end() || !(pull(*most) > 0)) break;
    free.push_back(*most);
    held.erase(most);
  }
  return step;
}

double NormalEquations::gain(const Eigen::VectorXd& step) const {
  return -step.dot(2 * gradient + matrix * step);
}

double ProjectedData::likely_cost(const Eigen::VectorXd& residual, double cost) const {
  if (!record_ || !record_->coloured || cost <= rounding_cost()) return cost;
  const auto count = static_cast<std::size_t>(residual.size());
  return std::exp(-2 * first_order_likelihood({residual.data(), count}).logarithm / static_cast<double>(count));
}

std::vector<double> ProjectedData::sizes(const Linear& linear) const {
  if (record_) {
    std::vector<double> size;
    for (const Complex s : s_) {
      const Eigen::ArrayXd phase = s.imag() * centre_ * record_->time.array();
      size.push_back(
          std::hypot((phase.cos() * linear.residual.array()).sum(), (phase.sin() * linear.residual.array()).sum()));
    }
    return size;
  }
  const auto points = static_cast<std::size_t>(s_.size());
  std::vector<double> size(points, 0.0);
  for (std::size_t i = 0; i < rows(); ++i) {
    size[i % points] = std::hypot(size[i % points], linear.residual[static_cast<Index>(i)]);
  }
  return size;
}

double schwarz(const ProjectedData& data, double cost, std::size_t parameters) {
  const auto n = static_cast<double>(data.rows());
  return n * std::log(std::max(cost, data.negligible_cost()) / n) +
         price_of_parameters(static_cast<double>(parameters), n);
}

double price_of_place(const ProjectedData& data) {
  return 2 * std::log(data.log_upper() - data.log_lower() + 2 * search_margin);
}

double price_of_point(const ProjectedData& data) {
  return 2 * std::log(static_cast<double>(data.log_omega().size()));
}

std::vector<double> places(const ProjectedData& data, int count) {
  const double first = data.log_lower() - search_margin, last = data.log_upper() + search_margin;
  std::vector<double> result;
  for (int i = 0; i < count; ++i) result.push_back(first + (last - first) * i / (count - 1));
  return result;
}

}  // namespace frac::detail
