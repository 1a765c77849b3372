// SPDX-License-Identifier: BSD-3-Clause
#include "rational_problem.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Poles may go three decades beyond the band: there s/p + 1 is 1, or s/p, to 1e-3, and the data lose sight of it.
constexpr double beyond_band = 7;
constexpr double most_damping = 9;  // sinh(9) is 4000: two real poles seven decades apart

Eigen::VectorXcd factor_values(const PoleFactor& factor, const Eigen::VectorXcd& s) {
  const double size = std::exp(factor.log_size);
  if (!factor.pair) return (s.array() / (factor.sign * size) + 1.0).matrix();
  const Eigen::ArrayXcd scaled = s.array() / size;
  return (scaled * scaled + 2 * std::sinh(factor.damping) * scaled + 1.0).matrix();
}

void sort_by_size(std::vector<PoleFactor>& factors) {
  std::stable_sort(factors.begin(), factors.end(),
                   [](const PoleFactor& a, const PoleFactor& b) { return a.log_size < b.log_size; });
}

/// Two real poles on the same side whose logarithms are this near become a pair, which may turn complex.
constexpr double near = 1.2;

bool join_near_poles(RationalShape& shape) {
  bool joined = false;
  sort_by_size(shape.factors);
  for (std::size_t i = 0; i + 1 < shape.factors.size(); ++i) {
    PoleFactor &a = shape.factors[i], &b = shape.factors[i + 1];
    if (a.pair || b.pair || a.sign != b.sign || b.log_size - a.log_size > near) continue;
    // (s + p)(s + q) = s^2 + (p + q) s + p q: sinh(damping) = (p + q)/(2 sqrt(p q)) = cosh of half the distance.
    a.damping = a.sign * std::asinh(std::cosh((b.log_size - a.log_size) / 2));
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
    const double distance = std::acosh(half);
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

}  // namespace

std::size_t RationalShape::order() const {
  std::size_t count = integrators;
  for (const PoleFactor& factor : factors) count += factor.pair ? 2 : 1;
  return count;
}

/// The linear part of a problem at given poles.
struct RationalProblem::Linear {
  Eigen::MatrixXd orthonormal;  // of the column space
  Eigen::VectorXd residual;
  Eigen::VectorXcd model;
  Eigen::VectorXd coefficients;  // of the basis
};

RationalProblem::RationalProblem(const FrequencyResponseData& data, const ResidualRule& rule)
    : form_(rule.form), centre_(std::sqrt(data.omega().front()) * std::sqrt(data.omega().back())) {
  const auto points = static_cast<Index>(data.size());
  log_lower_ = std::log(data.omega().front() / centre_);
  weight_.resize(points);
  s_.resize(points);
  Eigen::VectorXcd value(points);
  for (Index i = 0; i < points; ++i) {
    const auto at = static_cast<std::size_t>(i);
    log_omega_.push_back(std::log(data.omega()[at] / centre_));
    s_[i] = Complex(0, data.omega()[at] / centre_);
    weight_[i] = rule.weight[at];
    value[i] = data.value()[at];
  }
  target_.resize(form_ == ResidualForm::cartesian ? 2 * points : points);
  put(value, target_);
}

void RationalProblem::put(const Eigen::VectorXcd& values, Eigen::Ref<Eigen::VectorXd> column) const {
  const Index points = values.size();
  switch (form_) {
    case ResidualForm::real:
      column = weight_.cwiseProduct(values.real());
      break;
    case ResidualForm::imaginary:
      column = weight_.cwiseProduct(values.imag());
      break;
    default:
      column.head(points) = weight_.cwiseProduct(values.real());
      column.tail(points) = weight_.cwiseProduct(values.imag());
      break;
  }
}

// The numerators of degree `degree` are spanned by the partial products of the factors, slowest first, so that each
// column is the response of the faster poles alone: far better conditioned than powers of s.
Eigen::MatrixXcd RationalProblem::basis(const RationalShape& shape) const {
  Eigen::VectorXcd column = Eigen::VectorXcd::Ones(s_.size());
  if (shape.delayed) column = (-shape.delay * s_).array().exp().matrix();
  for (std::size_t i = shape.low; i < shape.integrators; ++i) column = column.cwiseQuotient(s_);
  for (std::size_t i = shape.integrators; i < shape.low; ++i) column = column.cwiseProduct(s_);
  for (const PoleFactor& factor : shape.factors) column = column.cwiseQuotient(factor_values(factor, s_));
  const auto count = static_cast<Index>(shape.degree - shape.low + 1);
  Eigen::MatrixXcd columns(s_.size(), count);
  Index filled = 0;
  const auto add = [&](const Eigen::VectorXcd& values) {
    if (filled < count) columns.col(filled++) = values;
  };
  for (const PoleFactor& factor : shape.factors) {
    if (filled == count) break;
    add(column);
    if (factor.pair) add(column.cwiseProduct(s_) / std::exp(factor.log_size));
    column = column.cwiseProduct(factor_values(factor, s_));
  }
  for (; filled < count; column = column.cwiseProduct(s_)) add(column);
  return columns;
}

bool RationalProblem::solve(const RationalShape& shape, Linear& linear) const {
  const Eigen::MatrixXcd columns = basis(shape);
  if (!columns.allFinite() || columns.cols() > target_.size()) return false;
  Eigen::MatrixXd matrix(target_.size(), columns.cols());
  for (Index k = 0; k < columns.cols(); ++k) put(columns.col(k), matrix.col(k));
  Eigen::VectorXd norm = matrix.colwise().norm();
  if (!norm.allFinite()) return false;
  // A column that is rounding beside the whole complex one is one that the fitted part is blind to.
  for (Index k = 0; k < norm.size(); ++k) {
    if (norm[k] > 1e-12 * weight_.cwiseProduct(columns.col(k).cwiseAbs()).norm()) continue;
    matrix.col(k).setZero();
    norm[k] = 1;
  }
  matrix *= norm.cwiseInverse().asDiagonal();
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition(matrix);
  decomposition.setThreshold(1e-11);
  const Index rank = decomposition.rank();
  if (rank == 0) return false;
  linear.orthonormal = Eigen::MatrixXd::Identity(target_.size(), rank);
  linear.orthonormal.applyOnTheLeft(decomposition.householderQ());
  linear.coefficients = decomposition.solve(target_).cwiseQuotient(norm);
  linear.model = columns * linear.coefficients.cast<Complex>();
  const Eigen::VectorXd share = linear.orthonormal.transpose() * target_;
  linear.residual = linear.orthonormal * share - target_;
  return linear.residual.allFinite() && linear.model.allFinite();
}

RationalFit RationalProblem::at(const RationalShape& shape) const {
  Linear linear;
  RationalFit fit{shape, infinity, 0};
  sort_by_size(fit.shape.factors);
  if (!solve(fit.shape, linear)) return fit;
  fit.cost = linear.residual.squaredNorm();
  fit.parameters = fit.shape.nonlinear() + static_cast<std::size_t>(linear.orthonormal.cols());
  return fit;
}

RationalFit RationalProblem::levenberg_marquardt(RationalShape shape, int iterations) const {
  sort_by_size(shape.factors);
  const auto width = static_cast<Index>(shape.nonlinear());
  Linear linear;
  if (!solve(shape, linear)) return {shape, infinity, 0};
  double cost = linear.residual.squaredNorm();
  double damping = 1e-3;
  int small_gains = 0;
  for (int iteration = 0; iteration < iterations && width > 0 && cost > rounding_cost(); ++iteration) {
    Eigen::MatrixXd jacobian(target_.size(), width);
    Index column = 0;
    const auto add = [&](const Eigen::VectorXcd& of_model) {
      auto here = jacobian.col(column++);
      put(of_model, here);
      here -= linear.orthonormal * (linear.orthonormal.transpose() * here).eval();
    };
    for (const PoleFactor& factor : shape.factors) {
      const Eigen::ArrayXcd value = factor_values(factor, s_).array();
      const Eigen::ArrayXcd scaled = s_.array() / std::exp(factor.log_size);
      if (!factor.pair) {
        add((linear.model.array() * factor.sign * scaled / value).matrix());
        continue;
      }
      add((linear.model.array() * (2.0 * scaled * scaled + 2 * std::sinh(factor.damping) * scaled) / value).matrix());
      add((linear.model.array() * (-2 * std::cosh(factor.damping)) * scaled / value).matrix());
    }
    if (shape.delayed) add((-s_.array() * linear.model.array()).matrix());
    if (!jacobian.allFinite()) break;
    const Eigen::MatrixXd normal = jacobian.transpose() * jacobian;
    const Eigen::VectorXd gradient = jacobian.transpose() * linear.residual;
    bool stepped = false;
    for (int attempt = 0; attempt < 8 && !stepped; ++attempt) {
      Eigen::MatrixXd damped = normal;
      const double least = 1e-14 * normal.diagonal().maxCoeff() + std::numeric_limits<double>::min();
      for (Index k = 0; k < width; ++k) damped(k, k) += damping * normal(k, k) + least;
      Eigen::VectorXd step = -damped.ldlt().solve(gradient);
      if (!step.allFinite()) break;
      // Two e-folds at most: the linear picture holds no further.
      const double largest = step.lpNorm<Eigen::Infinity>();
      if (largest > 2 && !shape.delayed) step *= 2 / largest;
      RationalShape next = shape;
      column = 0;
      for (PoleFactor& factor : next.factors) {
        factor.log_size = std::clamp(factor.log_size + std::clamp(step[column], -2.0, 2.0), log_lower_ - beyond_band,
                                     log_upper() + beyond_band);
        ++column;
        if (factor.pair) {
          factor.damping =
              std::clamp(factor.damping + std::clamp(step[column], -2.0, 2.0), -most_damping, most_damping);
          ++column;
        }
      }
      if (shape.delayed) next.delay = std::clamp(next.delay + step[column], 0.0, 6 * std::exp(-log_lower_));
      sort_by_size(next.factors);
      Linear there;
      const double tried = solve(next, there) ? there.residual.squaredNorm() : infinity;
      if (tried < cost) {
        small_gains = cost - tried < 1e-6 * cost ? small_gains + 1 : 0;
        cost = tried;
        shape = std::move(next);
        linear = std::move(there);
        damping = std::max(damping / 8, 1e-9);
        stepped = true;
      } else {
        damping = std::max(damping, 1e-6) * 6;
      }
    }
    if (!stepped || small_gains >= 2) break;
  }
  return {shape, cost, shape.nonlinear() + static_cast<std::size_t>(linear.orthonormal.cols())};
}

RationalFit RationalProblem::refine(const RationalShape& start, int iterations) const {
  RationalFit fit = levenberg_marquardt(start, iterations);
  for (int round = 0; round < 3; ++round) {
    RationalShape joined = fit.shape;
    split_real_pairs(joined);
    if (!join_near_poles(joined)) break;
    RationalFit next = levenberg_marquardt(joined, iterations);
    const bool paid = next.cost < fit.cost * (1 - 1e-4);
    if (next.cost < fit.cost) fit = std::move(next);
    if (!paid) break;
  }
  split_real_pairs(fit.shape);
  return fit;
}

std::vector<double> RationalProblem::residual_sizes(const RationalShape& shape) const {
  const auto points = static_cast<std::size_t>(s_.size());
  std::vector<double> size(points, 0.0);
  Linear linear;
  if (!solve(shape, linear)) return size;
  for (std::size_t i = 0; i < rows(); ++i) {
    size[i % points] = std::hypot(size[i % points], linear.residual[static_cast<Index>(i)]);
  }
  return size;
}

std::vector<double> RationalProblem::numerator(const RationalShape& shape) const {
  Linear linear;
  const std::size_t count = shape.degree - shape.low + 1;
  std::vector<double> result(count, 0.0);
  if (!solve(shape, linear)) return result;
  // The basis written out in powers of s, in the order of basis().
  std::vector<double> polynomial{1};
  const auto times = [](const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> product(a.size() + b.size() - 1, 0.0);
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t k = 0; k < b.size(); ++k) product[i + k] += a[i] * b[k];
    }
    return product;
  };
  std::size_t filled = 0;
  const auto add = [&](const std::vector<double>& powers) {
    if (filled == count) return;
    const double coefficient = linear.coefficients[static_cast<Index>(filled++)];
    for (std::size_t i = 0; i < powers.size() && i < count; ++i) result[i] += coefficient * powers[i];
  };
  for (const PoleFactor& factor : shape.factors) {
    if (filled == count) break;
    const double size = std::exp(factor.log_size);
    add(polynomial);
    if (factor.pair) {
      add(times(polynomial, {0, 1 / size}));
      polynomial = times(polynomial, {1, 2 * std::sinh(factor.damping) / size, 1 / (size * size)});
    } else {
      polynomial = times(polynomial, {1, factor.sign / size});
    }
  }
  for (; filled < count; polynomial = times(polynomial, {0, 1})) add(polynomial);
  // Integrators and the lowest power count in the scale of frequency, too.
  for (std::size_t i = 0; i < count; ++i) {
    const double power = static_cast<double>(shape.integrators) - static_cast<double>(i + shape.low);
    result[i] *= std::pow(centre_, power);
  }
  return result;
}

}  // namespace frac::detail
