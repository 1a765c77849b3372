// SPDX-License-Identifier: BSD-3-Clause
#include "gain_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "specification.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// Solution of a (count x count) system, empty where singular.
bool solve(double (&matrix)[3][4], int count, double (&solution)[3]) {
  for (int k = 0; k < count; ++k) {
    int pivot = k;
    for (int i = k + 1; i < count; ++i) {
      if (std::abs(matrix[i][k]) > std::abs(matrix[pivot][k])) pivot = i;
    }
    if (std::abs(matrix[pivot][k]) < 1e-300) return false;
    std::swap_ranges(matrix[k], matrix[k] + 4, matrix[pivot]);
    for (int i = k + 1; i < count; ++i) {
      const double factor = matrix[i][k] / matrix[k][k];
      for (int j = k; j < 4; ++j) matrix[i][j] -= factor * matrix[k][j];
    }
  }
  for (int k = count; k-- > 0;) {
    double sum = matrix[k][3];
    for (int j = k + 1; j < count; ++j) sum -= matrix[k][j] * solution[j];
    solution[k] = sum / matrix[k][k];
  }
  return true;
}

// The crossover asked for, or where the plant's phase has turned by 2 rad
// from its start, or the lower end of what the horizon shows.
double reference_frequency(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                           const TuningOptions& options) {
  if (asked.crossover) return *asked.crossover;
  const double slowest = options.horizon > 0   ? 1 / options.horizon
                         : asked.low_frequency ? asked.low_frequency->omega
                                               : 1e-6;
  const double order = plant.numerator().back().order - plant.denominator().back().order;
  double phase = order * pi / 2;
  const double target = std::min(-2.0, phase - 0.3);
  Complex before = 0;
  for (double omega = slowest; omega < 1e8 * slowest; omega *= 1.02) {
    const Complex value = plant.response(omega);
    if (before != 0.0) phase += std::arg(value / before);
    if (phase < target) return omega;
    before = value;
  }
  return 100 * slowest;
}

}  // namespace

GainSpace::GainSpace(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                     const TuningOptions& options)
    : asked_(asked),
      options_(options),
      reference_(reference_frequency(plant, asked, options)),
      plant_at_reference_(plant.response(reference_)),
      plant_slope_(log_slope(plant, reference_)) {
  uses_[0] = true;
  uses_[1] = options.structure != ControllerStructure::pd;
  uses_[2] = options.structure != ControllerStructure::pi;
  if (uses_[1]) add(Role::lambda, options.lambda.lower, options.lambda.upper);
  if (uses_[2]) add(Role::mu, options.mu.lower, std::min(options.mu.upper, highest_mu(plant, options)));
  if (asked.crossover) {
    if (!asked.phase_margin) add(Role::phase_margin, 0.1, 2.6);
    if (uses_[1] && uses_[2] && !asked.flat_phase) add(Role::share, 0, 1);
  } else {
    // Logarithm of each gain; 0 is the one that makes |L| = 1 at the reference frequency.
    for (int term = 0; term < 3; ++term) {
      if (uses_[term]) add(static_cast<Role>(static_cast<int>(Role::kp) + term), -9, 5);
    }
  }
}

void GainSpace::add(Role role, double lower, double upper) {
  if (lower == upper) return;
  roles_.push_back(role);
  lower_.push_back(lower);
  upper_.push_back(upper);
}

ControllerTerms GainSpace::terms_of(const FractionalPidGains& gains) const {
  return controller_terms(gains.lambda, gains.mu, options_.derivative_filter_time, reference_);
}

double GainSpace::phase_slope(const FractionalPidGains& gains) const {
  const ControllerTerms terms = terms_of(gains);
  const double gain[3] = {gains.kp, gains.ki, gains.kd};
  Complex value = 0;
  Complex by_log = 0;
  for (int i = 0; i < 3; ++i) {
    value += gain[i] * terms.value[i];
    by_log += gain[i] * terms.slope[i];
  }
  return plant_slope_.imag() + (by_log / value).imag();
}

GainSpace::Shares GainSpace::shares(const FractionalPidGains& gains) const {
  const ControllerTerms terms = terms_of(gains);
  const auto share = [&](double gain, int term) { return gain * std::abs(terms.value[term] * plant_at_reference_); };
  return {{share(gains.kp, 0), share(gains.ki, 1), share(gains.kd, 2)}};
}

FractionalPidGains GainSpace::gains(const std::vector<double>& x) const {
  FractionalPidGains gains{0, 0, 0, options_.lambda.lower, options_.mu.lower};
  if (!uses_[1]) gains.lambda = 1;
  if (!uses_[2]) gains.mu = 1;
  double phase_margin = asked_.phase_margin.value_or(1);
  double share = 0;
  double log_gain[3] = {0, 0, 0};
  for (std::size_t i = 0; i < x.size(); ++i) {
    switch (roles_[i]) {
      case Role::lambda:
        gains.lambda = x[i];
        break;
      case Role::mu:
        gains.mu = x[i];
        break;
      case Role::phase_margin:
        phase_margin = x[i];
        break;
      case Role::share:
        share = x[i];
        break;
      default:
        log_gain[static_cast<int>(roles_[i]) - static_cast<int>(Role::kp)] = x[i];
    }
  }
  const ControllerTerms terms = terms_of(gains);
  double* const gain[3] = {&gains.kp, &gains.ki, &gains.kd};
  if (!asked_.crossover) {
    for (int i = 0; i < 3; ++i) {
      if (uses_[i]) *gain[i] = std::exp(log_gain[i]) / std::abs(plant_at_reference_ * terms.value[i]);
    }
    return gains;
  }
  // C(j omega) = e^{j (phase_margin - pi)}/P; for flat phase also Im(dC/C) = -Im(dP/P), linear because C is known.
  const Complex target = std::polar(1.0, phase_margin - pi) / plant_at_reference_;
  int column[3];
  int columns = 0;
  for (int i = 0; i < 3; ++i) {
    if (uses_[i]) column[columns++] = i;
  }
  const auto row = [&](double(&to)[4], int kind, double right) {
    for (int k = 0; k < 3; ++k) {
      if (k >= columns) {
        to[k] = 0;
        continue;
      }
      const int i = column[k];
      to[k] = kind == 0   ? (terms.value[i] / target).real()
              : kind == 1 ? (terms.value[i] / target).imag()
                          : (terms.slope[i] / target).imag();
    }
    to[3] = right;
  };
  double solution[3] = {nothing, nothing, nothing};
  if (columns == 3 && !asked_.flat_phase) {
    share_out(terms, target, share, solution);
  } else {
    double matrix[3][4] = {};
    row(matrix[0], 0, 1);
    row(matrix[1], 1, 0);
    if (columns == 3) row(matrix[2], 2, -plant_slope_.imag());
    if (!solve(matrix, columns, solution)) solution[0] = nothing;
  }
  for (int k = 0; k < columns; ++k) *gain[column[k]] = solution[k];
  return gains;
}

// Of the line of gains with C = target the point at `share` of the piece on which none is negative; beyond it, where
// there is no such piece, the point at which the most negative is least so.
void GainSpace::share_out(const ControllerTerms& terms, Complex target, double share, double (&gain)[3]) const {
  Complex column[3];
  for (int i = 0; i < 3; ++i) column[i] = terms.value[i] / target;
  const auto cross = [](Complex a, Complex b) { return a.real() * b.imag() - a.imag() * b.real(); };
  const double direction[3] = {cross(column[1], column[2]), cross(column[2], column[0]), cross(column[0], column[1])};
  int largest = 0;
  for (int i = 1; i < 3; ++i) {
    if (std::abs(direction[i]) * std::abs(column[i]) > std::abs(direction[largest]) * std::abs(column[largest]))
      largest = i;
  }
  if (direction[largest] == 0) return;
  const int a = (largest + 1) % 3;
  const int b = (largest + 2) % 3;
  // Where no gain turns negative on one side: a term this many times the whole.
  constexpr double reach = 20;
  double point[3] = {0, 0, 0};
  point[a] = cross(Complex(1), column[b]) / cross(column[a], column[b]);
  point[b] = cross(column[a], Complex(1)) / cross(column[a], column[b]);
  const double farthest = reach / std::abs(direction[largest] * std::abs(column[largest]));
  double from = -farthest;
  double to = farthest;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) continue;
    const double zero = -point[i] / direction[i];
    (direction[i] > 0 ? from : to) = direction[i] > 0 ? std::max(from, zero) : std::min(to, zero);
  }
  // Finely where it begins, if it has no end.
  const double part = to == farthest ? std::pow(share, 3) : from == -farthest ? 1 - std::pow(1 - share, 3) : share;
  const double at = from + part * (to - from);
  for (int i = 0; i < 3; ++i) gain[i] = point[i] + at * direction[i];
}

}  // namespace frac::detail
