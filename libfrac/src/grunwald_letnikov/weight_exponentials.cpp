// SPDX-License-Identifier: BSD-3-Clause
#include "weight_exponentials.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace frac::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t most_tail_points = 16;

// Relative error of the trapezoidal rule of step h, at all k and b: with (1 - e^{-s})^{-b} = sum c_j e^{-js}, c_j > 0,
// Poisson's sum leaves 2 sum_m |Gamma(1 + 2 pi j m/h)| of every term, |Gamma(1 + j w)|^2 = pi w/sinh(pi w).
double trapezoid_error(double step) {
  double sum = 0;
  for (int m = 1; m <= 3; ++m) {
    const double w = 2 * pi * m / step;
    sum += 2 * std::sqrt(2 * pi * w) * std::exp(-pi * w / 2) / std::sqrt(-std::expm1(-2 * pi * w));
  }
  return sum;
}

// Largest step with that error: a fixed point of h = pi^2/ln(4 pi/(error sqrt h)), which contracts well.
double trapezoid_step(double error) {
  double step = 0.4;
  for (int i = 0; i < 6; ++i) step = pi * pi / std::log(4 * pi / (error * std::sqrt(step)));
  while (trapezoid_error(step) > error) step *= 0.999;
  return step;
}

class Measure {
 public:
  Measure(double b, double step) : b_(b), step_(step), factor_(step * std::sin(pi * std::min(b, 1 - b)) / pi) {}

  // Weight of the point s at index k.
  [[nodiscard]] double at(double s, double k) const {
    return factor_ * std::exp(std::log(s) - s * (k + b_) - b_ * std::log(-std::expm1(-s)));
  }
  // at(s, k) divided by s^(1-b), which is analytic at s = 0.
  [[nodiscard]] double smooth(double s, double k) const {
    const double ratio = s < 1e-8 ? 1 - s / 2 : -std::expm1(-s) / s;
    return factor_ * std::exp(-s * (k + b_)) * std::pow(ratio, -b_);
  }
  [[nodiscard]] double factor() const { return factor_; }
  // sum_j (s_c q^j)^(1-b), q = e^-step.
  [[nodiscard]] double tail_mass(double s_c) const { return std::pow(s_c, 1 - b_) / one_minus_power(1 - b_); }

  // Gauss rule of the points q^j with weights proportional to (q^(1-b))^j: little q-Jacobi polynomials with the
  // parameters q^-b and 1 (Koekoek, Lesky, Swarttouw 2010, section 14.12).
  struct Gauss {
    Eigen::VectorXd point;
    Eigen::VectorXd share;  // sum 1
  };
  [[nodiscard]] Gauss tail_rule(std::size_t points) const {
    const auto count = static_cast<Eigen::Index>(points);
    Eigen::VectorXd diagonal(count);
    Eigen::VectorXd beside(std::max<Eigen::Index>(count - 1, 0));
    double up_before = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto n = static_cast<double>(i);
      const double up_root = one_minus_power(n + 1 - b_);
      const double up = std::exp(-step_ * n) * up_root * up_root /
                        (one_minus_power(2 * n + 1 - b_) * one_minus_power(2 * n + 2 - b_));
      const double down_root = one_minus_power(n);
      const double down = i == 0 ? 0
                                 : std::exp(-step_ * (n - b_)) * down_root * down_root /
                                       (one_minus_power(2 * n - b_) * one_minus_power(2 * n + 1 - b_));
      diagonal[i] = up + down;
      if (i > 0) beside[i - 1] = std::sqrt(up_before * down);
      up_before = up;
    }
    using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_tail_points, most_tail_points>;
    Eigen::SelfAdjointEigenSolver<Matrix> solver;
    solver.computeFromTridiagonal(diagonal, beside);
    return {solver.eigenvalues(), solver.eigenvectors().row(0).transpose().cwiseAbs2()};
  }

 private:
  [[nodiscard]] double one_minus_power(double exponent) const { return -std::expm1(-step_ * exponent); }

  double b_;
  double step_;
  double factor_;
};

// w_k of order -b, to a few per cent from k = 1 on (Gautschi's inequality).
double size_of_weight(double b, double k) {
  return std::pow(k + b / 2, b - 1) / std::tgamma(b);
}

// Error of an m-point Gauss rule of mass 1 on [0, c] for e^-x: twice that of the best polynomial of degree 2m - 1,
// below the rest of the Chebyshev series 2 e^{-c/2} sum_{n >= 2m} I_n(c/2) with I_n(x) <= (x/2)^n e^{x^2/(4n+4)}/n!.
double gauss_error(std::size_t points, double c) {
  const double n = 2 * static_cast<double>(points);
  const double quarter = c / 4;
  if (quarter > 0.5 * n) return 1;
  return 4 / (1 - quarter / (n + 1)) *
         std::exp(n * std::log(quarter) - std::lgamma(n + 1) + quarter * quarter / (n + 1) - 2 * quarter);
}

}  // namespace

WeightExponentials weight_exponentials(double b, std::size_t first, double tolerance, double horizon) {
  const auto start = static_cast<double>(first);
  const double end = std::max(horizon, start + 1);
  const double step = trapezoid_step(0.5 * tolerance);
  const Measure measure(b, step);

  // Beyond the largest point at most an eighth of the tolerance is left out at the first index, where most is.
  const double allowed = 0.125 * tolerance * size_of_weight(b, start);
  double largest = std::log(1 / tolerance) / start;
  const auto left_out = [&] {
    return 1.5 * (measure.at(largest * std::exp(step), start) + measure.at(largest * std::exp(2 * step), start));
  };
  while (left_out() > allowed) largest *= 1.02;

  // The division between points kept and points replaced that leaves the fewest.
  const double relative_mass = measure.factor() / size_of_weight(b, end);
  std::size_t kept = 0;
  std::size_t tail = 0;
  double tail_error = 0;
  for (std::size_t points = 2; points <= most_tail_points; ++points) {
    const auto error = [&](std::size_t before) {
      const double s_c = largest * std::exp(-step * static_cast<double>(before));
      // Half a unit of s and more is not small against the scale on which (1 - e^{-s})/s bends.
      return s_c > 0.5 ? 1 : relative_mass * measure.tail_mass(s_c) * gauss_error(points, s_c * (end + b));
    };
    std::size_t before = tail == 0 ? 0 : kept > 40 ? kept - 40 : 0;
    while (error(before) > 0.25 * tolerance) ++before;
    if (tail == 0 || before + points < kept + tail) {
      kept = before;
      tail = points;
      tail_error = error(before);
    }
  }
  WeightExponentials result{{}, trapezoid_error(step) + left_out() / size_of_weight(b, start) + tail_error};
  for (std::size_t i = 0; i < kept; ++i) {
    const double s = largest * std::exp(-step * static_cast<double>(i));
    result.terms.push_back({s, measure.at(s, start)});
  }
  const double s_c = largest * std::exp(-step * static_cast<double>(kept));
  const double mass = measure.tail_mass(s_c);
  const Measure::Gauss gauss = measure.tail_rule(tail);
  for (Eigen::Index i = gauss.point.size(); i-- > 0;) {
    const double s = s_c * std::max(gauss.point[i], 0.0);
    result.terms.push_back({s, mass * gauss.share[i] * measure.smooth(s, start)});
  }
  return result;
}

}  // namespace frac::detail
