// SPDX-License-Identifier: BSD-3-Clause
#include "term_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
// An arc may lie that many e-folds beyond the band: there an arc of order 1 is a constant, or 1/s, to 1e-3.
constexpr double beyond_band = 7;
// From a peak of 4000, which data show none sharper than, to a damping of a half: beyond it two arcs say the same.
constexpr double least_log_damping = -9, most_log_damping = -0.7;
// Times spread by a twentieth of an e-fold are one time to 1e-3 of its lag, and by 400 they are every time of any band.
constexpr double least_log_width = -3, most_log_width = 6;

Eigen::ArrayXcd scaled(const Term& term, const ProjectedData& data) {
  return data.s().array() * std::exp(-term.log_size);
}

/// 1 + 2 z x + x^2
Eigen::ArrayXcd denominator(const Term& mode, const Eigen::ArrayXcd& x) {
  return 1.0 + x * (2 * std::exp(mode.log_damping) + x);
}

/// A spread of lags with its changes by ln T and by ln width.
struct Spread {
  Eigen::ArrayXcd value, by_size, by_width;
};

/// With x = s T the mean of v(u) = 1/(1 + x e^u) over |u| < w is 1 - L/(2 w), L = ln(1 + x e^w) - ln(1 + x e^-w).
Spread even_spread(const Eigen::ArrayXcd& x, double width) {
  const Eigen::ArrayXcd upper = 1.0 + x * std::exp(width), lower = 1.0 + x * std::exp(-width);
  const Eigen::ArrayXcd share = (upper.log() - lower.log()) / (2 * width);
  const Eigen::ArrayXcd fast = 1.0 / lower, slow = 1.0 / upper;
  return {1.0 - share, (slow - fast) / (2 * width), share - 1.0 + (fast + slow) / 2.0};
}

/// The mean of v(u) over normal u by the trapezoidal rule of step h.  Its error is exp(-2 pi d/h + d^2/(2 w^2)) for
/// each d within which the integrand has no pole, here pi/2, and thus below 1e-9.  With x = i y, z = y e^u and
/// r = 1/(1 + z^2) it is v = r (1 - i z), and v (v - 1) = -r^2 (2 z^2 + i z (1 - z^2)).
Spread normal_spread(const Eigen::ArrayXd& y, double width) {
  constexpr double deviations = 7, pole_step = 0.3, density_step = 0.85;
  const double step = std::min(pole_step, density_step * width);
  const int half = static_cast<int>(std::ceil(deviations * width / step));
  Spread spread{Eigen::ArrayXcd::Zero(y.size()), Eigen::ArrayXcd::Zero(y.size()), Eigen::ArrayXcd::Zero(y.size())};
  double total = 0;
  for (int k = -half; k <= half; ++k) total += std::exp(-0.5 * std::pow(k * step / width, 2));
  for (int k = -half; k <= half; ++k) {
    const double u = k * step, weight = std::exp(-0.5 * std::pow(u / width, 2)) / total;
    const double size = std::exp(std::min(u, 300.0));  // v is nothing from there on, and z^2 not infinite
    for (Index i = 0; i < y.size(); ++i) {
      const double z = y(i) * size, share = weight / (1 + z * z), steep = -share * z / (1 + z * z);
      const Complex change(2 * z * steep, steep * (1 - z * z));
      spread.value(i) += Complex(share, -z * share);
      spread.by_size(i) += change;
      spread.by_width(i) += u * change;
    }
  }
  return spread;
}

Spread spread_of(const Term& term, const ProjectedData& data) {
  const double width = std::exp(term.log_width);
  const Eigen::ArrayXcd x = scaled(term, data);
  return term.kind == Term::Kind::even_spread ? even_spread(x, width) : normal_spread(x.imag(), width);
}

/// x^q + x^2
Eigen::ArrayXcd structural_denominator(const Term& mode, const ProjectedData& data) {
  return data.power(std::exp(mode.log_damping), -mode.log_size) + scaled(mode, data).square();
}

/// d ln(value) / d log_size of a term with a held order that is neither power, arc nor mode.
Eigen::ArrayXcd by_log_size(const Term& term, const ProjectedData& data, const Eigen::ArrayXcd& value) {
  const Eigen::ArrayXcd x = scaled(term, data);
  // With y = sqrt(x), d/d log_size = -y/2 d/dy, and (tanh y)' = 1 - tanh^2 y, (coth y)' = 1 - coth^2 y.
  return term.kind == Term::Kind::gerischer ? Eigen::ArrayXcd(0.5 * x / (1.0 + x))
                                            : Eigen::ArrayXcd(0.5 * (1.0 + value * x - value.inverse()));
}

Eigen::ArrayXcd column_of(const Term& term, const ProjectedData& data) {
  switch (term.kind) {
    case Term::Kind::normal_spread:
    case Term::Kind::even_spread:
      return spread_of(term, data).value;
    case Term::Kind::arc:
      return reciprocal(1.0 + data.power(term.order, -term.log_size));
    case Term::Kind::rise:
      // With the inverse power neither end overflows into a quotient of infinities.
      return reciprocal(1.0 + data.power(-term.order, -term.log_size));
    case Term::Kind::gerischer:
      return (1.0 + scaled(term, data)).sqrt().inverse();
    case Term::Kind::layer_short: {
      const Eigen::ArrayXcd root = data.power(0.5, -term.log_size);
      return root.tanh() / root;
    }
    case Term::Kind::layer_open: {
      const Eigen::ArrayXcd root = data.power(0.5, -term.log_size);
      return 1.0 / (root * root.tanh());
    }
    case Term::Kind::structural_mode: {
      const Eigen::ArrayXcd x = scaled(term, data);
      return (term.order > 0 ? x : Eigen::ArrayXcd::Ones(x.size())) * reciprocal(structural_denominator(term, data));
    }
    case Term::Kind::mode: {
      const Eigen::ArrayXcd x = scaled(term, data);
      return (term.order > 0 ? x : Eigen::ArrayXcd::Ones(x.size())) * reciprocal(denominator(term, x));
    }
    default:
      return data.power(term.order);
  }
}

/// Parameters that the residuals can tell apart.
/// @param rank  of the columns
std::size_t parameters(const TermSum& sum, Index rank) {
  std::size_t count = static_cast<std::size_t>(rank);
  for (const Term& term : sum) count += term.nonlinear();
  return count;
}

/// The sum with each of the terms, at infinite cost.
std::vector<TermFit> with_each(const TermSum& sum, const std::vector<Term>& terms) {
  std::vector<TermFit> fits;
  for (const Term& term : terms) fits.push_back({with_term(sum, term), std::numeric_limits<double>::infinity(), 0});
  return fits;
}

}  // namespace

bool same_power(const Term& a, const Term& b) {
  return a.kind == Term::Kind::power && b.kind == Term::Kind::power && a.order == b.order;
}

TermSum with_term(TermSum sum, const Term& term) {
  sum.push_back(term);
  return sum;
}

TermSum without_term(TermSum sum, std::size_t k) {
  sum.erase(sum.begin() + static_cast<std::ptrdiff_t>(k));
  return sum;
}

bool costs_less(const TermFit& a, const TermFit& b) {
  return a.cost < b.cost;
}

void TermProblem::refine_best(std::vector<TermFit> starts, std::size_t count, std::vector<TermFit>& refined) const {
  std::stable_sort(starts.begin(), starts.end(), costs_less);
  for (std::size_t i = 0; i < std::min(count, starts.size()); ++i) {
    refined.push_back(refine(std::move(starts[i].sum), scouting));
  }
}

Eigen::MatrixXcd TermProblem::columns(const TermSum& sum) const {
  Eigen::MatrixXcd result(s().size(), static_cast<Index>(sum.size()));
  for (std::size_t k = 0; k < sum.size(); ++k) {
    result.col(static_cast<Index>(k)) = column_of(sum[k], *this).matrix();
  }
  return result;
}

Eigen::MatrixXcd TermProblem::derivatives(const TermSum& sum, const Linear& linear) const {
  std::size_t width = 0;
  for (const Term& term : sum) width += term.nonlinear();
  Eigen::MatrixXcd result(s().size(), static_cast<Index>(width));
  Index column = 0;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Term& term = sum[k];
    if (term.nonlinear() == 0) continue;
    const double coefficient = linear.coefficients[static_cast<Index>(k)];
    if (term.is_spread()) {
      const Spread spread = spread_of(term, *this);
      result.col(column++) = (-coefficient * spread.by_size).matrix();
      result.col(column++) = (coefficient * spread.by_width).matrix();
      continue;
    }
    const Eigen::ArrayXcd value = linear.columns.col(static_cast<Index>(k));
    if (term.kind == Term::Kind::mode) {
      const Eigen::ArrayXcd x = scaled(term, *this), damped = 2 * std::exp(term.log_damping) * x,
                            share = reciprocal(denominator(term, x));
      result.col(column++) = (coefficient * value * ((damped + 2.0 * x * x) * share - term.order)).matrix();
      result.col(column++) = (-coefficient * value * damped * share).matrix();
      continue;
    }
    if (term.kind == Term::Kind::structural_mode) {
      const Eigen::ArrayXcd elastic = power(std::exp(term.log_damping), -term.log_size),
                            inertial = scaled(term, *this).square();
      const double q = std::exp(term.log_damping);
      const Eigen::ArrayXcd share = reciprocal(elastic + inertial);
      result.col(column++) = (coefficient * value * ((q * elastic + 2.0 * inertial) * share - term.order)).matrix();
      result.col(column++) = (-coefficient * value * q * elastic * share * (log_s().array() - term.log_size)).matrix();
      continue;
    }
    if (term.kind == Term::Kind::power) {
      result.col(column++) = (coefficient * value * log_s().array()).matrix();
      continue;
    }
    if (term.kind != Term::Kind::arc && term.kind != Term::Kind::rise) {
      result.col(column++) = (coefficient * value * by_log_size(term, *this, value)).matrix();
      continue;
    }
    // With x = (s T)^n, the arc v = 1/(1 + x) has dv = -v^2 dx = -v (1 - v) d ln x, and 1 - v the opposite.
    const double sign = term.kind == Term::Kind::arc ? -1 : 1;
    const Eigen::ArrayXcd by_log = sign * coefficient * value * (1.0 - value);
    result.col(column++) = (-term.order * by_log).matrix();
    if (!term.held) result.col(column++) = (by_log * (log_s().array() - term.log_size)).matrix();
  }
  return result;
}

StepBounds TermProblem::step_bounds(const TermSum& sum) const {
  constexpr double e_folds = 2, of_order = 0.2;
  StepBounds result(3 * sum.size());
  for (const Term& term : sum) {
    if (term.kind != Term::Kind::power) {
      result.add(e_folds, term.log_size, log_lower() - beyond_band, log_upper() + beyond_band);
    }
    if (term.is_mode()) result.add(e_folds, term.log_damping, least_log_damping, most_log_damping);
    if (term.is_spread()) result.add(1, term.log_width, least_log_width, most_log_width);
    if (term.held) continue;
    const bool power = term.kind == Term::Kind::power;
    result.add(of_order, term.order, power ? term.least_order : least_arc_order, power ? term.most_order : 1.0);
  }
  return result;
}

TermSum TermProblem::stepped(const TermSum& sum, const Eigen::VectorXd& step) const {
  TermSum next = sum;
  Index column = 0;
  for (Term& term : next) {
    if (term.kind != Term::Kind::power) term.log_size += step[column++];
    if (term.is_mode()) term.log_damping += step[column++];
    if (term.is_spread()) term.log_width += step[column++];
    if (!term.held) term.order += step[column++];
  }
  return next;
}

std::vector<TermFit> TermProblem::along(const TermSum& sum, const std::vector<Term>& terms) const {
  Linear linear;
  const bool is_finite = solve(columns(sum), linear);
  std::vector<TermFit> fits = with_each(sum, terms);
  for (TermFit& fit : fits) {
    if (is_finite) fit.cost = cost_with(linear, column_of(fit.sum.back(), *this).matrix());
  }
  return fits;
}

std::vector<TermFit> TermProblem::along_gaining(const TermSum& sum, const Linear& linear,
                                                const std::vector<Term>& terms, Eigen::MatrixXd further) const {
  std::vector<TermFit> fits = with_each(sum, terms);
  // The second time takes what rounding of the first has left.
  for (int pass = 0; pass < 2; ++pass) remove_span(linear.orthonormal, further);
  for (std::size_t k = 0; k < terms.size(); ++k) {
    const auto column = further.col(static_cast<Index>(k));
    const double length = column.norm(), along = column.dot(linear.residual);
    constexpr double rounding = 1e-11;
    // The residual is model less data, so that a positive coefficient goes against it.
    if (length > rounding && along < 0) fits[k].cost = linear.cost - along * along / (length * length);
  }
  return fits;
}

TermFit TermProblem::refine(TermSum sum, const Effort& effort) const {
  Linear linear;
  if (sum.empty() || !gauss_newton(*this, *this, sum, linear, effort)) {
    return {std::move(sum), std::numeric_limits<double>::infinity(), 0};
  }
  const std::size_t count = parameters(sum, linear.orthonormal.cols());
  return {std::move(sum), linear.cost, count};
}

std::vector<Complex> TermProblem::response(const TermSum& sum) const {
  Linear linear;
  if (!solve(columns(sum), linear)) return {};
  return {linear.model.begin(), linear.model.end()};
}

std::vector<double> TermProblem::coefficients(const TermSum& sum) const {
  Linear linear;
  std::vector<double> result(sum.size(), 0.0);
  if (!solve(columns(sum), linear)) return result;
  for (std::size_t k = 0; k < sum.size(); ++k) {
    result[k] = linear.coefficients[static_cast<Index>(k)];
    if (sum[k].kind == Term::Kind::power) result[k] *= std::pow(centre_omega(), -sum[k].order);
  }
  return result;
}

}  // namespace frac::detail
