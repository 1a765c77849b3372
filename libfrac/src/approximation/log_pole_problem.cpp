// SPDX-License-Identifier: BSD-3-Clause
#include "log_pole_problem.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "base/linear_algebra.hpp"
#include "flux_law.hpp"
#include "ladder_sensitivity.hpp"

namespace frac::detail {
namespace {

using Extended = long double;
using ExtendedComplex = std::complex<Extended>;

// k-th positive zero of the Bessel function J_order, |order| < 1, by McMahon (within 0.2 %).  Where the first goes to
// zero, order -> -1, from the quotient of two Rayleigh sums, joined to McMahon at order 0: what matters more than the
// last digit is that poles and zeros, which stand at J_-a and J_a, meet neither at a -> 0 nor at a -> 1.
double bessel_zero(double order, int k) {
  const auto mcmahon = [](double of, int index) {
    const double leading = (index + of / 2 - 0.25) * std::numbers::pi;
    return leading - (4 * of * of - 1) / (8 * leading);
  };
  if (k > 1 || order >= 0) return mcmahon(order, k);
  const auto rayleigh = [](double of) { return std::sqrt(8 * (of + 1) * (of + 2) * (of + 4) / (5 * of + 11)); };
  return rayleigh(order) * (1 + (1 + order) * (mcmahon(0, 1) / rayleigh(0) - 1));
}

// |e^E - 1|, and the same at the mirrored frequency, where the logarithmic error is -conj E.
double relative_error(ExtendedComplex logarithmic) {
  const double real = static_cast<double>(logarithmic.real());
  const double imaginary = static_cast<double>(logarithmic.imag());
  const double half_sine = std::sin(imaginary / 2);
  const auto at = [&](double log_gain) {
    return std::hypot(std::expm1(log_gain), 2 * std::exp(log_gain / 2) * half_sine);
  };
  return std::max(at(real), at(-real));
}

std::vector<double> values_of(const LogPoles& log_poles) {
  std::vector<double> poles;
  for (const Extended x : log_poles) poles.push_back(static_cast<double>(std::exp(x)));
  return poles;
}

struct Solution {
  std::vector<double> change;
  double remaining;  // norm of the residual after it
};

Solution least_squares(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& residual) {
  const Eigen::VectorXd change = PivotedQr(matrix).solve(residual);
  if (!change.allFinite()) return {{}, 0};
  return {{change.begin(), change.end()}, (residual - matrix * change).norm()};
}

// Four per pole in half the band: some eight per turn of the error, which turns once per pole.
int grid_points(int poles) {
  return std::max(4 * poles + 4, 24);
}

}  // namespace

// Poles stand at equal steps of the flux; the shares next to the two ends follow the zeros of J_-a and J_a, as they do
// for the Pade approximant of s^a, whose zeros and poles are zeros of Jacobi polynomials.
LogPoles starting_log_poles(const UnitProblem& problem, int poles) {
  const FluxLaw law(problem.half_width);
  const auto beyond_evenly = [](double order, int k) {
    return bessel_zero(order, k) / std::numbers::pi - (k + order / 2 - 0.25);
  };
  LogPoles logarithms;
  for (int i = 0; i < poles; ++i) {
    const double even = 2 * (i + 0.75 + problem.order / 2) / (poles + 0.5) - 1;
    const double ends = beyond_evenly(problem.order, i + 1) - beyond_evenly(-problem.order, poles - i);
    logarithms.push_back(law.position(even + 2 * ends / (poles + 0.5)));
  }
  return logarithms;
}

bool interlaced(const LogPoles& log_poles) {
  const std::size_t count = log_poles.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Extended zero_below = -log_poles[count - 1 - i];
    if (!(log_poles[i] > zero_below)) return false;
    if (i + 1 < count && !(log_poles[i] < -log_poles[count - 2 - i])) return false;
  }
  return true;
}

LogPoles moved(const LogPoles& log_poles, const std::vector<double>& change, double share) {
  LogPoles result = log_poles;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] += share * change[k];
  return result;
}

LogPoleProblem::LogPoleProblem(const UnitProblem& problem, int poles)
    : order_(problem.order), poles_(poles), log_omega_(FluxLaw(problem.half_width).band_grid(grid_points(poles))) {
  for (const double t : log_omega_) omega_.push_back(std::exp(static_cast<Extended>(t)));
  weight_.assign(omega_.size(), 1 / static_cast<double>(omega_.size()));
}

// H = prod (1 + j omega p)/(p + j omega).
void LogPoleProblem::evaluate(const LogPoles& log_poles) {
  std::vector<Extended> pole;
  Extended log_gain = 0;
  for (const Extended x : log_poles) {
    pole.push_back(std::exp(x));
    log_gain -= x;
  }
  const Extended quarter = std::numbers::pi_v<Extended> / 2 * static_cast<Extended>(order_);
  const ExtendedComplex turn(std::cos(quarter), -std::sin(quarter));
  error_.resize(omega_.size());
  measure_.resize(omega_.size());
  largest_ = 0;
  for (std::size_t i = 0; i < omega_.size(); ++i) {
    const Extended omega = omega_[i];
    Extended numerator_real = 1, numerator_imaginary = 0, denominator_real = 1, denominator_imaginary = 0;
    for (const Extended p : pole) {
      const Extended q = omega * p;
      const Extended r = omega / p;
      const Extended numerator = numerator_real - q * numerator_imaginary;
      numerator_imaginary += q * numerator_real;
      numerator_real = numerator;
      const Extended denominator = denominator_real - r * denominator_imaginary;
      denominator_imaginary += r * denominator_real;
      denominator_real = denominator;
    }
    const ExtendedComplex ratio =
        ExtendedComplex(numerator_real, numerator_imaginary) / ExtendedComplex(denominator_real, denominator_imaginary);
    error_[i] = std::log(ratio * turn) + (log_gain - static_cast<Extended>(order_) * log_omega_[i]);
    measure_[i] = relative_error(error_[i]);
    largest_ = std::max(largest_, measure_[i]);
  }
}

double LogPoleProblem::weighted_mean() const {
  double sum = 0;
  for (std::size_t i = 0; i < measure_.size(); ++i) sum += weight_[i] * measure_[i] * measure_[i];
  return std::sqrt(sum);
}

double LogPoleProblem::power_mean(int power) const {
  double largest = 0;
  for (const ExtendedComplex& error : error_) largest = std::max(largest, static_cast<double>(std::abs(error)));
  if (largest == 0) return 0;
  double sum = 0;
  for (const ExtendedComplex& error : error_) sum += std::pow(static_cast<double>(std::abs(error)) / largest, power);
  return largest * std::pow(sum / static_cast<double>(error_.size()), 1.0 / power);
}

void LogPoleProblem::sharpen(double power) {
  double sum = 0;
  for (std::size_t i = 0; i < measure_.size(); ++i) {
    weight_[i] *= std::pow(measure_[i] / largest_, power);
    sum += weight_[i];
  }
  for (double& weight : weight_) weight /= sum;
}

LogPoleProblem::Step LogPoleProblem::weighted_step(const LogPoles& log_poles, double damping) const {
  const std::vector<double> poles = values_of(log_poles);
  const auto points = static_cast<Eigen::Index>(omega_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2 * points + poles_, poles_);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(2 * points + poles_);
  matrix.bottomRows(poles_).diagonal().setConstant(damping * weighted_mean());
  for (Eigen::Index i = 0; i < points; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const double length = static_cast<double>(std::abs(error_[index]));
    const double scale = std::sqrt(weight_[index]) * (length > 0 ? measure_[index] / length : 1);
    residual[2 * i] = -scale * static_cast<double>(error_[index].real());
    residual[2 * i + 1] = -scale * static_cast<double>(error_[index].imag());
    for (Eigen::Index k = 0; k < poles_; ++k) {
      const auto slope =
          scale * ladder_sensitivity(static_cast<double>(omega_[index]), poles[static_cast<std::size_t>(k)]);
      matrix(2 * i, k) = slope.real();
      matrix(2 * i + 1, k) = slope.imag();
    }
  }
  Solution solution = least_squares(matrix, residual);
  return {std::move(solution.change), solution.remaining};
}

// With w = |E|^(power-2) and u = Re(conj(E) dE)/|E|, the second derivative of sum |E|^power/power is
// sum w (Re(conj(dE) dE) + (power - 2) u u), the gradient sum w Re(conj(E) dE): normal equations of the rows
// sqrt(w) dE against -sqrt(w) E and sqrt(w (power - 2)) u against 0.
std::vector<double> LogPoleProblem::power_step(const LogPoles& log_poles, int power, double damping) const {
  const std::vector<double> poles = values_of(log_poles);
  const auto points = static_cast<Eigen::Index>(omega_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * points + poles_, poles_);
  Eigen::VectorXd residual = Eigen::VectorXd::Zero(3 * points + poles_);
  const double mean = power_mean(power);
  matrix.bottomRows(poles_).diagonal().setConstant(damping * mean);
  for (Eigen::Index i = 0; i < points; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const std::complex<double> error(error_[index]);
    const double length = std::abs(error);
    if (length == 0) continue;
    const double scale = std::pow(length / mean, (power - 2) / 2.0);
    const std::complex<double> direction = error / length;
    residual[3 * i] = -scale * error.real();
    residual[3 * i + 1] = -scale * error.imag();
    for (Eigen::Index k = 0; k < poles_; ++k) {
      const auto slope =
          scale * ladder_sensitivity(static_cast<double>(omega_[index]), poles[static_cast<std::size_t>(k)]);
      matrix(3 * i, k) = slope.real();
      matrix(3 * i + 1, k) = slope.imag();
      matrix(3 * i + 2, k) =
          std::sqrt(power - 2.0) * (direction.real() * slope.real() + direction.imag() * slope.imag());
    }
  }
  return least_squares(matrix, residual).change;
}

}  // namespace frac::detail
