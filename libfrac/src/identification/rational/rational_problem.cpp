// SPDX-License-Identifier: BSD-3-Clause
#include "rational_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <utility>

#include "base/polynomial.hpp"
#include "base/wide_vectors.hpp"
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

/// z = s^order = size (along + i across) over the points, all of one phase.
struct Power {
  const double* size;
  double along, across;
};

/// Values over the points, real and imaginary parts apart, which wide registers take side by side.
struct Values {
  double *re, *im;
};

/// Arrays of the calling thread, valid until it makes the next room.
class Room {
 public:
  Room(std::size_t arrays, std::size_t points) : points_(points) {
    thread_local std::vector<double> all;
    if (all.size() < arrays * points) all.resize(arrays * points);
    next_ = all.data();
  }
  double* array() { return std::exchange(next_, next_ + points_); }
  Values values() {
    double* const re = array();
    return {re, array()};
  }

 private:
  std::size_t points_;
  double* next_;
};

Power power_of(const ProjectedData& data, double order, double* size) {
  data.power_sizes(order, size);
  if (order == 1) return {size, 0, 1};
  return {size, std::cos(order * std::numbers::pi / 2), std::sin(order * std::numbers::pi / 2)};
}

/// A factor with its numbers: with x = scale size it is 1 + x (linear z' + x z'^2), z' = z/size, without the square
/// unless it is a pair.
struct FactorNumbers {
  FactorNumbers(const PoleFactor& factor, const Power& z, double order)
      : scale(std::exp(-order * factor.log_size)), half(std::sinh(factor.damping)) {
    const double linear = factor.pair ? 2 * half : factor.sign;
    re1 = linear * z.along;
    im1 = linear * z.across;
    if (!factor.pair) return;
    re2 = z.along * z.along - z.across * z.across;
    im2 = 2 * z.along * z.across;
  }
  double scale, half;  // of (s/w)^order over size, and sinh(damping)
  double re1, im1, re2 = 0, im2 = 0;

  FRACFIT_INLINE double re(double x) const { return 1 + x * (re1 + x * re2); }
  FRACFIT_INLINE double im(double x) const { return x * (im1 + x * im2); }
};

FRACFIT_INLINE inline void multiply(Values by, std::size_t points, Values values) {
  for (std::size_t i = 0; i < points; ++i) {
    const double re = values.re[i] * by.re[i] - values.im[i] * by.im[i];
    values.im[i] = values.re[i] * by.im[i] + values.im[i] * by.re[i];
    values.re[i] = re;
  }
}
/// Times scale z.
FRACFIT_INLINE inline void multiply(const Power& z, double scale, std::size_t points, Values from, Values to) {
  const double along = scale * z.along, across = scale * z.across;
  for (std::size_t i = 0; i < points; ++i) {
    const double re = z.size[i] * (from.re[i] * along - from.im[i] * across);
    to.im[i] = z.size[i] * (from.re[i] * across + from.im[i] * along);
    to.re[i] = re;
  }
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

/// The numerators of degree `degree` are spanned by the partial products of the factors, slowest first, so that each
/// column is the response of the faster poles alone: far better conditioned than powers of z.
/// @param with_order  whether the order is searched for
/// @param visit  gets each column and, if asked for, d ln column / d order
template <bool with_order, class Visit>
FRACFIT_INLINE inline void visit_columns(const ProjectedData& data, const RationalShape& shape, const Power& z,
                                         Room& room, const Visit& visit) {
  const std::size_t points = data.log_omega().size();
  const double* const log_omega = data.log_omega().data();
  const Values column = room.values(), next = room.values(), by_order = with_order ? room.values() : Values{};
  if (shape.delayed) {
    const Eigen::ArrayXcd delayed = data.delayed(shape.delay);
    for (std::size_t i = 0; i < points; ++i) {
      column.re[i] = delayed[static_cast<Index>(i)].real();
      column.im[i] = delayed[static_cast<Index>(i)].imag();
    }
  } else {
    std::fill_n(column.re, points, 1.0);
    std::fill_n(column.im, points, 0.0);
  }
  const double excess = static_cast<double>(shape.low) - static_cast<double>(shape.integrators);
  if (excess != 0) {
    const Values by = room.values();
    const Power whole = power_of(data, excess * shape.order, by.re);
    multiply(whole, 1, points, column, column);
  }
  // d/d order of powers (s/size)^order is ln(s/size) times them.
  const auto add_log = [&](double times, double log_size) FRACFIT_INLINE {
    for (std::size_t i = 0; i < points; ++i) {
      by_order.re[i] += times * (log_omega[i] - log_size);
      by_order.im[i] += times * std::numbers::pi / 2;
    }
  };
  if constexpr (with_order) {
    std::fill_n(by_order.re, points, 0.0);
    std::fill_n(by_order.im, points, 0.0);
    add_log(excess, 0);
  }
  struct OfFactor {
    FactorNumbers numbers;
    Values value, change;
  };
  std::vector<OfFactor> of_factors;
  of_factors.reserve(shape.factors.size());
  for (const PoleFactor& factor : shape.factors) {
    of_factors.push_back({FactorNumbers(factor, z, shape.order), room.values(), with_order ? room.values() : Values{}});
    const auto& [numbers, value, change] = of_factors.back();
    for (std::size_t i = 0; i < points; ++i) {
      const double x = numbers.scale * z.size[i], re = numbers.re(x), im = numbers.im(x);
      const double share = 1 / (re * re + im * im);
      const double column_re = share * (column.re[i] * re + column.im[i] * im);
      column.im[i] = share * (column.im[i] * re - column.re[i] * im);
      column.re[i] = column_re;
      value.re[i] = re;
      value.im[i] = im;
    }
    if constexpr (with_order) {
      for (std::size_t i = 0; i < points; ++i) {
        // x d factor / d x = x (linear z' + 2 x z'^2), over the factor, times ln(s/size).
        const double x = numbers.scale * z.size[i], re = value.re[i], im = value.im[i];
        const double share = x / (re * re + im * im);
        const double slope_re = numbers.re1 + 2 * x * numbers.re2, slope_im = numbers.im1 + 2 * x * numbers.im2;
        const double by_log_re = share * (slope_re * re + slope_im * im),
                     by_log_im = share * (slope_im * re - slope_re * im);
        const double log_re = log_omega[i] - factor.log_size, log_im = std::numbers::pi / 2;
        change.re[i] = by_log_re * log_re - by_log_im * log_im;
        change.im[i] = by_log_re * log_im + by_log_im * log_re;
        by_order.re[i] -= change.re[i];
        by_order.im[i] -= change.im[i];
      }
    }
  }
  const std::size_t count = shape.degree - shape.low + 1;
  std::size_t filled = 0;
  for (std::size_t k = 0; k < of_factors.size() && filled < count; ++k) {
    const PoleFactor& factor = shape.factors[k];
    visit(filled++, column, by_order);
    if (factor.pair && filled < count) {
      multiply(z, of_factors[k].numbers.scale, points, column, next);
      if constexpr (with_order) add_log(1, factor.log_size);
      visit(filled++, next, by_order);
      if constexpr (with_order) add_log(-1, factor.log_size);
    }
    multiply(of_factors[k].value, points, column);
    if constexpr (with_order) {
      for (std::size_t i = 0; i < points; ++i) {
        by_order.re[i] += of_factors[k].change.re[i];
        by_order.im[i] += of_factors[k].change.im[i];
      }
    }
  }
  for (; filled < count;) {
    visit(filled++, column, by_order);
    multiply(z, 1, points, column, column);
    if constexpr (with_order) add_log(1, 0);
  }
}

FRACFIT_INLINE inline void put_together(Values values, std::size_t points, Complex* to) {
  auto* const parts = reinterpret_cast<double*>(to);
  for (std::size_t i = 0; i < points; ++i) {
    parts[2 * i] = values.re[i];
    parts[2 * i + 1] = values.im[i];
  }
}

/// Arrays that visit_columns() takes, and a few more.
std::size_t arrays_for(const RationalShape& shape) {
  return 12 + 4 * shape.factors.size();
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
  const auto points = static_cast<std::size_t>(s().size());
  Eigen::MatrixXcd result(s().size(), static_cast<Index>(shape.degree - shape.low + 1));
  Room room(arrays_for(shape), points);
  const Power z = power_of(*this, shape.order, room.array());
  with_wide_vectors([&]() FRACFIT_INLINE {
    visit_columns<false>(*this, shape, z, room, [&](std::size_t k, Values column, Values) FRACFIT_INLINE {
      put_together(column, points, result.col(static_cast<Index>(k)).data());
    });
  });
  return result;
}

Eigen::MatrixXcd RationalProblem::columns_of(const PoleFactor& factor, const RationalShape& shape) const {
  RationalShape alone = shape;
  alone.factors = {factor};
  alone.integrators = alone.low = 0;
  alone.degree = factor.pair ? 1 : 0;
  return columns(alone);
}

Eigen::MatrixXcd RationalProblem::derivatives(const RationalShape& shape, const Linear& linear) const {
  const auto points = static_cast<std::size_t>(s().size());
  Eigen::MatrixXcd result(s().size(), static_cast<Index>(shape.nonlinear()));
  Eigen::VectorXcd answered;
  if (record_) {
    const Eigen::MatrixXcd values = frequency_columns(shape);
    answered = values * linear.coefficients.head(values.cols()).cast<Complex>();
  }
  const Eigen::VectorXcd& value = record_ ? answered : linear.model;
  const auto* const model = reinterpret_cast<const double*>(value.data());
  Room room(arrays_for(shape), points);
  const Power z = power_of(*this, shape.order, room.array());
  Index column = 0;
  const auto next = [&] { return reinterpret_cast<double*>(result.col(column++).data()); };
  with_wide_vectors([&]() FRACFIT_INLINE {
    for (const PoleFactor& factor : shape.factors) {
      const FactorNumbers numbers(factor, z, shape.order);
      double* const by_size = next();
      double* const by_damping = factor.pair ? next() : nullptr;
      const double of_size = factor.pair ? 2 * shape.order : shape.order * factor.sign,
                   of_damping = -2 * std::cosh(factor.damping);
      for (std::size_t i = 0; i < points; ++i) {
        const double x = numbers.scale * z.size[i], re = numbers.re(x), im = numbers.im(x);
        const double at_re = x * z.along, at_im = x * z.across;
        // model (s/size)^order / factor
        const double over = 1 / (re * re + im * im);
        const double part_re = over * (at_re * re + at_im * im), part_im = over * (at_im * re - at_re * im);
        const double share_re = model[2 * i] * part_re - model[2 * i + 1] * part_im,
                     share_im = model[2 * i] * part_im + model[2 * i + 1] * part_re;
        if (by_damping) {
          const double inner = at_re + numbers.half;
          by_size[2 * i] = of_size * (share_re * inner - share_im * at_im);
          by_size[2 * i + 1] = of_size * (share_re * at_im + share_im * inner);
          by_damping[2 * i] = of_damping * share_re;
          by_damping[2 * i + 1] = of_damping * share_im;
        } else {
          by_size[2 * i] = of_size * share_re;
          by_size[2 * i + 1] = of_size * share_im;
        }
      }
    }
  });
  if (shape.delayed) result.col(column++) = (-s().array() * value.array()).matrix();
  if (shape.searches_order()) {
    const Values change = room.values();
    std::fill_n(change.re, points, 0.0);
    std::fill_n(change.im, points, 0.0);
    with_wide_vectors([&]() FRACFIT_INLINE {
      visit_columns<true>(*this, shape, z, room, [&](std::size_t k, Values values, Values by_order) FRACFIT_INLINE {
        const double coefficient = linear.coefficients[static_cast<Index>(k)];
        for (std::size_t i = 0; i < points; ++i) {
          change.re[i] += coefficient * (values.re[i] * by_order.re[i] - values.im[i] * by_order.im[i]);
          change.im[i] += coefficient * (values.re[i] * by_order.im[i] + values.im[i] * by_order.re[i]);
        }
      });
    });
    put_together(change, points, result.col(column++).data());
  }
  return record_ ? record_->derivatives(shape, log_s(), value, result, linear.coefficients) : result;
}

StepBounds RationalProblem::step_bounds(const RationalShape& shape) const {
  constexpr double e_folds = 2, of_order = 0.2;
  const double least_damping = poles_ == Poles::anywhere ? -most_damping
                               : poles_ == Poles::stable ? least_stable_damping(shape.order)
                                                         : 0;
  StepBounds result(2 * shape.factors.size() + 2);
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
  fit.parameters = parameter_count(fit.shape, projection->columns.basis.cols());
  fit.likely_cost = likely_cost(projection->columns.rest, projection->cost);
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
