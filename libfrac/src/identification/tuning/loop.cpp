// SPDX-License-Identifier: BSD-3-Clause
#include "loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "frac/fractional_derivative.hpp"
#include "frac/laplace_value.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Around an undamped pole, as a share of its frequency.
constexpr double way_around = 1e-4;

Complex power(double order, double omega) {
  return std::polar(std::pow(omega, order), order * pi / 2);
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * pi);
}

// Returns the point nearest to the origin of the straight line between two points.
Complex nearest_to_origin(Complex from, Complex to) {
  const Complex way = to - from;
  const double length = std::norm(way);
  if (length == 0) return to;
  const double share = -(from.real() * way.real() + from.imag() * way.imag()) / length;
  return from + std::clamp(share, 0.0, 1.0) * way;
}

FractionalTransferFunction with_less_delay(const FractionalTransferFunction& plant, double by) {
  return {plant.numerator(), plant.denominator(), std::max(0.0, plant.delay() - by)};
}

}  // namespace

Complex log_slope(const FractionalTransferFunction& model, double omega) {
  const auto slope = [&](const std::vector<PowerTerm>& terms) {
    Complex sum = 0;
    Complex weighted = 0;
    for (const PowerTerm& term : terms) {
      const Complex each = term.coefficient * power(term.order, omega);
      sum += each;
      weighted += term.order * each;
    }
    return weighted / sum;
  };
  return slope(model.numerator()) - slope(model.denominator()) - Complex(0, model.delay() * omega);
}

ControllerTerms controller_terms(double lambda, double mu, double filter_time, double omega) {
  const Complex lag = 1.0 + Complex(0, filter_time * omega);
  ControllerTerms terms{{1, power(-lambda, omega), power(mu, omega) / lag}, {}};
  terms.slope[0] = 0;
  terms.slope[1] = -lambda * terms.value[1];
  terms.slope[2] = (mu - Complex(0, filter_time * omega) / lag) * terms.value[2];
  return terms;
}

LoopGrid::LoopGrid(const FractionalTransferFunction& plant, double centre, const std::vector<double>& bounds)
    : plant_(plant),
      order_at_origin_(plant.numerator().back().order - plant.denominator().back().order),
      order_at_infinity_(plant.numerator().front().order - plant.denominator().front().order),
      gain_at_origin_(plant.numerator().back().coefficient / plant.denominator().back().coefficient),
      gain_at_infinity_(plant.numerator().front().coefficient / plant.denominator().front().coefficient) {
  constexpr double decades = 4.5;
  constexpr int points = 271;  // thirty per decade
  std::vector<double> omega;
  for (int i = 0; i < points; ++i) omega.push_back(centre * std::pow(10, decades * (2.0 * i / (points - 1) - 1)));
  std::vector<double> undamped;
  for (const Pole& pole : analyse_stability(plant).poles) {
    if (pole.cancelled) continue;
    const double size = std::abs(pole.value);
    const double damping = std::abs(pole.value.real()) / size;
    if (damping < 1e-9) {
      undamped.push_back(size);
      continue;
    }
    if (pole.value.real() > 0) unstable_plant_poles_ += pole.multiplicity * (pole.value.imag() == 0 ? 1 : 2);
    if (!(damping < 0.3)) continue;
    for (int i = -8; i <= 8; ++i) omega.push_back(size * std::exp(0.5 * damping * i));
  }
  for (const double pole : undamped) {
    // Closer and closer, as |L| grows without bound.
    for (double distance = 0.05; distance > 2 * way_around; distance /= 2) {
      omega.push_back(pole * (1 - distance));
      omega.push_back(pole * (1 + distance));
    }
  }
  omega.insert(omega.end(), bounds.begin(), bounds.end());
  for (const double pole : undamped) {
    std::erase_if(omega, [&](double each) { return std::abs(each - pole) <= 1.5 * way_around * pole; });
    omega.push_back(pole);
  }
  std::sort(omega.begin(), omega.end());
  for (const double each : omega) {
    if (std::find(undamped.begin(), undamped.end(), each) != undamped.end()) {
      go_around(each);
    } else {
      points_.push_back({each, pi / 2, plant.response(each)});
    }
  }
}

// Half a circle to the right of the pole at j omega.
void LoopGrid::go_around(double pole) {
  constexpr int pieces = 16;
  for (int i = 0; i <= pieces; ++i) {
    const Complex s = Complex(0, pole) + std::polar(way_around * pole, pi * (static_cast<double>(i) / pieces - 0.5));
    points_.push_back({std::abs(s), std::arg(s), laplace_value(plant_, s)});
  }
}

LoopGrid::Peaks LoopGrid::peaks(const FractionalPidGains& gains, double filter_time, double high, double low) const {
  Peaks peaks{0, 0, 0, 0, 0};
  Complex previous = 0;
  double turned = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto [omega, angle, plant_value] = points_[i];
    const auto power_here = [&, omega = omega, angle = angle](double order) {
      return std::polar(std::pow(omega, order), order * angle);
    };
    Complex controller = gains.kp;
    if (gains.ki != 0) controller += gains.ki * power_here(-gains.lambda);
    if (gains.kd != 0) controller += gains.kd * power_here(gains.mu) / (1.0 + filter_time * std::polar(omega, angle));
    const Complex loop = plant_value * controller;
    const Complex difference = 1.0 + loop;
    // Where dead time turns L by more than half a radian from point to point, the worst phase counts.
    const bool fast = 0.08 * omega * plant_.delay() > 0.5;
    // Else the way from the last point is taken to be straight, so that no narrow peak hides between two points.
    const Complex nearest = i == 0 || fast ? difference : nearest_to_origin(previous, difference);
    const double sensitivity = fast ? 1 / std::max(1 - std::abs(loop), 1e-9) : 1 / std::abs(nearest);
    const double complementary = (fast ? std::abs(loop) : std::abs(nearest - 1.0)) * sensitivity;
    peaks.sensitivity = std::max(peaks.sensitivity, sensitivity);
    peaks.complementary_sensitivity = std::max(peaks.complementary_sensitivity, complementary);
    if (omega >= high) peaks.high_frequency = std::max(peaks.high_frequency, complementary);
    if (omega <= low) peaks.low_frequency = std::max(peaks.low_frequency, sensitivity);
    if (i > 0) turned += std::arg(difference / previous);
    if (i == 0) {
      // From the limit at the origin: 1 + L ~ c (j omega)^-r for r > 0.
      const double order = order_at_origin_ - (gains.ki > 0 ? gains.lambda : 0);
      const double start = order < 0 ? order * pi / 2 + (gain_at_origin_ < 0 ? pi : 0) : 0;
      turned += order < 0 ? wrapped(std::arg(difference) - start) : 0;
      peaks.unstable_poles = unstable_plant_poles_ + (order < 0 ? -order / 2 : 0);
    }
    previous = difference;
  }
  // To the limit at infinity, where L falls to 0, or keeps a gain, or grows and turns like a power.
  const double order = order_at_infinity_ + (gains.kd > 0 ? gains.mu - (filter_time > 0 ? 1 : 0) : 0);
  if (order > 0) {
    turned += wrapped(order * pi / 2 + (gain_at_infinity_ < 0 ? pi : 0) - std::arg(previous));
    peaks.unstable_poles += order / 2;
  } else {
    turned -= std::arg(previous);
  }
  peaks.unstable_poles -= turned / pi;
  return peaks;
}

LoopSimulation::LoopSimulation(const FractionalTransferFunction& plant, double horizon, bool load_step, int samples)
    : step_(horizon / samples),
      load_step_(load_step),
      samples_(samples),
      // The filter answers the present sample one step later than the loop would want it: dead time makes up for it.
      filter_(with_less_delay(plant, step_), step_, 1e-6, Hold::zero_order, samples) {}

ErrorIntegrals LoopSimulation::operator()(const FractionalPidGains& gains, double filter_time) {
  constexpr double tolerance = 1e-6;
  constexpr double run_away = 1e6;
  filter_.reset();
  std::optional<FractionalDerivative<double>> integral;
  std::optional<FractionalDerivative<double>> derivative;
  if (gains.ki != 0) integral.emplace(-gains.lambda, step_, tolerance, samples_);
  if (gains.kd != 0) derivative.emplace(gains.mu, step_, tolerance, samples_);
  const double share = step_ / (filter_time + step_);
  double filtered = 0;
  double output = 0;
  ErrorIntegrals result{0, 0};
  for (int n = 0; n < samples_; ++n) {
    const double error = (load_step_ ? 0 : 1) - output;
    double control = gains.kp * error + (load_step_ ? 1 : 0);
    if (integral) control += gains.ki * integral->step(error);
    if (derivative) {
      filtered += share * (derivative->step(error) - filtered);
      control += gains.kd * filtered;
    }
    result.iae += std::abs(error) * step_;
    result.itae += std::abs(error) * step_ * (n * step_);
    output = filter_.step(control);
    if (!(std::abs(output) < run_away)) {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      return {infinity, infinity};
    }
  }
  return result;
}

}  // namespace frac::detail
