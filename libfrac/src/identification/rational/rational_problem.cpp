// SPDX-License-Identifier: BSD-3-Clause
#include "rational_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "base/polynomial.hpp"
#include "identification/data/physical_properties.hpp"
#include "identification/search/thinned.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Poles may go three decades beyond the band: there s/p + 1 is 1, or s/p, to 1e-3, and the data lose sight of it.
constexpr double beyond_band = 7;
constexpr double most_damping = 9;  // sinh(9) is 4000: two real poles seven decades apart

/// z = s^order.
Eigen::ArrayXcd powers(const ProjectedData& data, double order) {
  if (order == 1) return data.s().array();
  return data.power(order);
}

/// (s/size)^order
Eigen::ArrayXcd scaled(const PoleFactor& factor, const Eigen::ArrayXcd& z, double order) {
  return z * std::exp(-order * factor.log_size);
}

Eigen::ArrayXcd factor_values(const PoleFactor& factor, const Eigen::ArrayXcd& z, double order) {
  const Eigen::ArrayXcd at = scaled(factor, z, order);
  if (!factor.pair) return factor.sign * at + 1.0;
  return at * at + 2 * std::sinh(factor.damping) * at + 1.0;
}

/// At most `count` of the observed outputs, at one place by chance in each of as many equal parts of the record: at
/// even steps a fast motion would look like a slow one.
TimeResponseData some_outputs(const TimeResponseData& data, std::size_t count) {
  const std::vector<std::size_t>& all = data.observed();
  if (all.size() <= count) return data;
  std::mt19937_64 generator(1);
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = i * all.size() / count, to = (i + 1) * all.size() / count;
    chosen.push_back(all[from + generator() % (to - from)]);
  }
  return data.observed_at(std::move(chosen));
}

double least_stable_damping(double order) {
  return std::asinh(least_sinh_damping(order) + at_the_edge);
}

void sort_by_size(std::vector<PoleFactor>& factors) {
  std::stable_sort(factors.begin(), factors.end(),
                   [](const PoleFactor& a, const PoleFactor& b) { return a.log_size < b.log_size; });
}

/// Two real poles on the same side whose logarithms in z are this near become a pair, which may turn complex.
constexpr double near = 1.2;

bool join_near_poles(RationalShape& shape) {
  bool joined = false;
  sort_by_size(shape.factors);
  for (std::size_t i = 0; i + 1 < shape.factors.size(); ++i) {
    PoleFactor &a = shape.factors[i], &b = shape.factors[i + 1];
    const double distance = shape.order * (b.log_size - a.log_size);
    if (a.pair || b.pair || a.sign != b.sign || distance > near) continue;
    // (z + p)(z + q) = z^2 + (p + q) z + p q: sinh(damping) = (p + q)/(2 sqrt(p q)) = cosh of half the distance.
    a.damping = a.sign * std::asinh(std::cosh(distance / 2));
    a.log_size = (a.log_size + b.log_size) / 2;
    a.pair = true;
    shape.factors.erase(shape.factors.begin() + static_cast<std::ptrdiff_t>(i) + 1);
    joined = true;
  }
  return joined;
}

/// Pairs with two real poles become these.
void split_real_pairs(RationalShape& shape) {
  const std::size_t count = shape.factors.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double half = std::abs(std::sinh(shape.factors[i].damping));
    if (!shape.factors[i].pair || half < 1) continue;
    const double distance = std::acosh(half) / shape.order;
    PoleFactor high = shape.factors[i];
    high.pair = false;
    high.sign = high.damping > 0 ? 1 : -1;
    high.damping = 0;
    shape.factors[i] = high;
    shape.factors[i].log_size -= distance;
    high.log_size += distance;
    shape.factors.push_back(high);
  }
  sort_by_size(shape.factors);
}

/// d ln factor / d order, of which every power (s/size)^order makes (s/size)^order ln(s/size).
Eigen::ArrayXcd factor_by_order(const PoleFactor& factor, const Eigen::ArrayXcd& z, const Eigen::ArrayXcd& log_s,
                                double order) {
  const Eigen::ArrayXcd at = scaled(factor, z, order);
  const Eigen::ArrayXcd share = at * (log_s - factor.log_size) * reciprocal(factor_values(factor, z, order));
  if (!factor.pair) return factor.sign * share;
  return 2 * share * (at + std::sinh(factor.damping));
}

/// The numerators of degree `degree` are spanned by the partial products of the factors, slowest first, so that each
/// column is the response of the faster poles alone: far better conditioned than powers of z.
/// @param with_order  whether the order is searched for
/// @param visit  gets each column and d ln column / d order, which has no entries unless asked for
template <class Visit>
void visit_columns(const ProjectedData& data, const RationalShape& shape, bool with_order, const Visit& visit) {
  const Eigen::ArrayXcd z = powers(data, shape.order), log_s = data.log_s().array();
  Eigen::ArrayXcd column = Eigen::ArrayXcd::Ones(z.size()), by_order;
  if (shape.delayed) column = data.delayed(shape.delay);
  for (std::size_t i = shape.low; i < shape.integrators; ++i) column /= z;
  for (std::size_t i = shape.integrators; i < shape.low; ++i) column *= z;
  if (with_order) by_order = (static_cast<double>(shape.low) - static_cast<double>(shape.integrators)) * log_s;
  std::vector<Eigen::ArrayXcd> of_factor, change;
  for (const PoleFactor& factor : shape.factors) {
    of_factor.push_back(factor_values(factor, z, shape.order));
    column *= reciprocal(of_factor.back());
    if (!with_order) continue;
    change.push_back(factor_by_order(factor, z, log_s, shape.order));
    by_order -= change.back();
  }
  const std::size_t count = shape.degree - shape.low + 1;
  std::size_t filled = 0;
  for (std::size_t i = 0; i < shape.factors.size() && filled < count; ++i) {
    const PoleFactor& factor = shape.factors[i];
    visit(column, by_order);
    ++filled;
    if (factor.pair && filled < count) {
      const Eigen::ArrayXcd next = column * scaled(factor, z, shape.order);
      visit(next, with_order ? Eigen::ArrayXcd(by_order + log_s - factor.log_size) : by_order);
      ++filled;
    }
    column *= of_factor[i];
    if (with_order) by_order += change[i];
  }
  for (; filled < count; ++filled) {
    visit(column, by_order);
    column *= z;
    if (with_order) by_order += log_s;
  }
}

}  // namespace

double least_sinh_damping(double order) {
  return order == 1 ? 0 : -std::cos(order * std::numbers::pi / 2);
}

bool is_unstable(const RationalShape& shape) {
  return std::any_of(shape.factors.begin(), shape.factors.end(), [&](const PoleFactor& factor) {
    return factor.pair ? std::sinh(factor.damping) < least_sinh_damping(shape.order) - at_the_edge : factor.sign < 0;
  });
}

RationalProblem::RationalProblem(const FrequencyResponseData& data, const ResidualRule& rule, Poles poles)
    : ProjectedData(data, rule),
      poles_(poles),
      longest_delay_(std::min(6 * std::exp(-log_lower()), longest_dead_time(data) * centre_omega())) {
  // Up to 12 poles and as many zeros.
  constexpr std::size_t scouted = 80;
  if (2 * data.size() < 3 * scouted) return;
  const Thinned thin = thinned(data, rule, scouted);
  const auto few = std::make_shared<RationalProblem>(thin.data, thin.rule, poles);
  few->longest_delay_ = longest_delay_;
  few_ = few;
}

RationalProblem::RationalProblem(const TimeResponseData& data, const TimeFitOptions& options, Poles poles,
                                 std::size_t outputs)
    : ProjectedData(record_rows(some_outputs(data, outputs), options)),
      poles_(poles),
      record_(std::make_shared<RecordAnswers>(some_outputs(data, outputs), options.earlier_input, centre_omega())),
      longest_delay_((data.time().back() - data.time().front()) * centre_omega()) {}

// Up to 12 poles and as many zeros, an offset and a drift.
RationalProblem::RationalProblem(const TimeResponseData& data, const TimeFitOptions& options, Poles poles)
    : RationalProblem(data, options, poles, 400) {
  constexpr std::size_t scouted = 100;
  if (points() > scouted) few_.reset(new RationalProblem(data, options, poles, scouted));
}

std::size_t RationalProblem::parameter_count(const RationalShape& shape, Eigen::Index rank) const {
  return shape.nonlinear() + static_cast<std::size_t>(rank) - (record_ ? record_->free_motion_count(shape) : 0);
}

std::size_t RationalShape::poles() const {
  std::size_t count = integrators;
  for (const PoleFactor& factor : factors) count += factor.pair ? 2 : 1;
  return count;
}

std::size_t RationalShape::relaxations() const {
  const auto stable = [](const PoleFactor& factor) { return !factor.pair && factor.sign > 0; };
  return static_cast<std::size_t>(std::count_if(factors.begin(), factors.end(), stable)) + (delayed ? 1 : 0);
}

Eigen::MatrixXcd RationalProblem::columns(const RationalShape& shape) const {
  Eigen::MatrixXcd values = frequency_columns(shape);
  return record_ ? record_->columns(shape, log_s(), values) : values;
}

Eigen::MatrixXcd RationalProblem::frequency_columns(const RationalShape& shape) const {
  Eigen::MatrixXcd result(s().size(), static_cast<Index>(shape.degree - shape.low + 1));
  Index filled = 0;
  visit_columns(*this, shape, false, [&](const Eigen::ArrayXcd& column, const Eigen::ArrayXcd& /*by_order*/) {
    result.col(filled++) = column.matrix();
  });
  return result;
}

Eigen::MatrixXcd RationalProblem::columns_of(const PoleFactor& factor, const RationalShape& shape) const {
  const Eigen::ArrayXcd z = powers(*this, shape.order);
  Eigen::ArrayXcd part = reciprocal(factor_values(factor, z, shape.order));
  if (shape.delayed) part *= delayed(shape.delay);
  Eigen::MatrixXcd result(z.size(), factor.pair ? 2 : 1);
  result.col(0) = part.matrix();
  if (factor.pair) result.col(1) = (part * scaled(factor, z, shape.order)).matrix();
  if (!record_) return result;
  RationalShape alone = shape;
  alone.factors = {factor};
  alone.integrators = alone.low = alone.degree = 0;
  return record_->columns(alone, log_s(), result);
}

Eigen::MatrixXcd RationalProblem::derivatives(const RationalShape& shape, const Linear& linear) const {
  const Eigen::ArrayXcd z = powers(*this, shape.order);
  Eigen::ArrayXcd model = linear.model.array();
  if (record_) {
    const Eigen::MatrixXcd values = frequency_columns(shape);
    model = (values * linear.coefficients.head(values.cols()).cast<Complex>()).array();
  }
  Eigen::MatrixXcd result(z.size(), static_cast<Index>(shape.nonlinear()));
  Index column = 0;
  for (const PoleFactor& factor : shape.factors) {
    const Eigen::ArrayXcd at = scaled(factor, z, shape.order);
    const Eigen::ArrayXcd share = model * at * reciprocal(factor_values(factor, z, shape.order));
    if (!factor.pair) {
      result.col(column++) = (shape.order * factor.sign * share).matrix();
      continue;
    }
    result.col(column++) = (2 * shape.order * share * (at + std::sinh(factor.damping))).matrix();
    result.col(column++) = (-2 * std::cosh(factor.damping) * share).matrix();
  }
  if (shape.delayed) result.col(column++) = (-s().array() * model).matrix();
  if (shape.searches_order()) {
    Eigen::ArrayXcd change = Eigen::ArrayXcd::Zero(z.size());
    Index filled = 0;
    visit_columns(*this, shape, true, [&](const Eigen::ArrayXcd& values, const Eigen::ArrayXcd& by_order) {
      change += linear.coefficients[filled++] * values * by_order;
    });
    result.col(column++) = change.matrix();
  }
  return record_ ? record_->derivatives(shape, log_s(), model.matrix(), result, linear.coefficients) : result;
}

StepBounds RationalProblem::step_bounds(const RationalShape& shape) const {
  constexpr double e_folds = 2, of_order = 0.2;
  const double least_damping = poles_ == Poles::anywhere ? -most_damping
                               : poles_ == Poles::stable ? least_stable_damping(shape.order)
                                                         : 0;
  StepBounds result;
  const double beyond = beyond_band / shape.order;
  for (const PoleFactor& factor : shape.factors) {
    result.add(e_folds, factor.log_size, log_lower() - beyond, log_upper() + beyond);
    if (factor.pair) result.add(e_folds, factor.damping, least_damping, most_damping);
  }
  // Radians at the upper end of the band, or as much again.
  if (shape.delayed) {
    result.add(std::max(shape.delay, e_folds * std::exp(-log_upper())), shape.delay, 0, longest_delay_);
  }
  if (shape.searches_order()) result.add(of_order, shape.order, least_order, most_order);
  return result;
}

RationalShape RationalProblem::stepped(const RationalShape& shape, const Eigen::VectorXd& step) const {
  RationalShape next = shape;
  Index column = 0;
  for (PoleFactor& factor : next.factors) {
    factor.log_size += step[column++];
    if (factor.pair) factor.damping += step[column++];
  }
  if (shape.delayed) next.delay += step[column++];
  if (shape.searches_order()) next.order += step[column++];
  keep_in_sector(next);
  sort_by_size(next.factors);
  return next;
}

void RationalProblem::keep_in_sector(RationalShape& shape) const {
  if (poles_ != Poles::stable) return;
  for (PoleFactor& factor : shape.factors) {
    if (factor.pair) factor.damping = std::max(factor.damping, least_stable_damping(shape.order));
  }
}

RationalFit RationalProblem::at(const RationalShape& shape) const {
  RationalFit fit{shape, infinity, 0};
  keep_in_sector(fit.shape);
  sort_by_size(fit.shape.factors);
  const std::optional<Projection> projection = project(columns(fit.shape));
  if (!projection) return fit;
  fit.cost = projection->cost;
  fit.parameters = parameter_count(fit.shape, projection->orthonormal.cols());
  fit.likely_cost = likely_cost(projection->residual, projection->cost);
  return fit;
}

RationalFit RationalProblem::searched(RationalShape shape, const Effort& effort) const {
  keep_in_sector(shape);
  sort_by_size(shape.factors);
  Linear linear;
  if (!gauss_newton(*this, *this, shape, linear, effort)) return {shape, infinity, 0};
  return {shape, linear.cost, parameter_count(shape, linear.orthonormal.cols()),
          likely_cost(linear.residual, linear.cost)};
}

RationalFit RationalProblem::refine(const RationalShape& start, const Effort& effort) const {
  RationalFit fit = searched(start, effort);
  for (int round = 0; round < 3; ++round) {
    RationalShape joined = fit.shape;
    split_real_pairs(joined);
    if (!join_near_poles(joined)) break;
    RationalFit next = searched(joined, effort);
    const bool paid = next.cost < fit.cost * (1 - 1e-4);
    if (next.cost < fit.cost) fit = std::move(next);
    if (!paid) break;
  }
  split_real_pairs(fit.shape);
  return fit;
}

double RationalProblem::correlation(const RationalShape& shape) const {
  Linear linear;
  if (!solve(columns(shape), linear)) return 0;
  // Real parts stand before imaginary ones.
  double product = 0;
  for (std::size_t i = 1; i < rows(); ++i) {
    if (i % points() != 0)
      product += linear.residual[static_cast<Index>(i)] * linear.residual[static_cast<Index>(i - 1)];
  }
  return linear.cost > 0 ? product / linear.cost : 0;
}

std::vector<double> RationalProblem::residual_sizes(const RationalShape& shape) const {
  Linear linear;
  if (!solve(columns(shape), linear)) return std::vector<double>(log_omega().size(), 0.0);
  return sizes(linear);
}

std::vector<std::complex<double>> RationalProblem::response(const RationalShape& shape) const {
  Linear linear;
  if (!solve(columns(shape), linear)) return {};
  return {linear.model.begin(), linear.model.end()};
}

std::vector<double> RationalProblem::numerator(const RationalShape& shape) const {
  Linear linear;
  const std::size_t count = shape.degree - shape.low + 1;
  std::vector<double> result(count, 0.0);
  if (!solve(columns(shape), linear)) return result;
  // The basis written out in powers of z, in the order of columns().
  std::vector<double> polynomial{1};
  std::size_t filled = 0;
  const auto add = [&](const std::vector<double>& of_z) {
    if (filled == count) return;
    const double coefficient = linear.coefficients[static_cast<Index>(filled++)];
    for (std::size_t i = 0; i < of_z.size() && i < count; ++i) result[i] += coefficient * of_z[i];
  };
  for (const PoleFactor& factor : shape.factors) {
    if (filled == count) break;
    const double size = std::exp(shape.order * factor.log_size);
    add(polynomial);
    if (factor.pair) {
      add(polynomial_product(polynomial, {0, 1 / size}));
      polynomial = polynomial_product(polynomial, {1, 2 * std::sinh(factor.damping) / size, 1 / (size * size)});
    } else {
      polynomial = polynomial_product(polynomial, {1, factor.sign / size});
    }
  }
  while (filled < count) {
    add(polynomial);
    polynomial = polynomial_product(polynomial, {0, 1});
  }
  // Integrators and the lowest power count in the scale of frequency, too.
  for (std::size_t i = 0; i < count; ++i) {
    const double power = static_cast<double>(shape.integrators) - static_cast<double>(i + shape.low);
    result[i] *= std::pow(centre_omega(), shape.order * power);
  }
  return result;
}

}  // namespace frac::detail
