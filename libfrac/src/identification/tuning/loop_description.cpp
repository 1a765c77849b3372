// SPDX-License-Identifier: BSD-3-Clause
#include "loop_description.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>

#include "base/number_text.hpp"
#include "formula/power_sum.hpp"
#include "loop.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Extreme {
  double value = 0;
  double omega = 0;
};

// Largest of a function of omega between two frequencies: a grid of two hundred points per decade, and a golden section
// about the largest of them.
template <typename Function>
Extreme largest(const Function& function, double from, double to) {
  const int points = std::max(3, static_cast<int>(200 * std::log10(to / from)));
  const auto at = [&](double share) { return from * std::pow(to / from, share); };
  int place = 0;
  double value = -1;
  for (int i = 0; i <= points; ++i) {
    const double each = function(at(static_cast<double>(i) / points));
    if (each > value) {
      value = each;
      place = i;
    }
  }
  double left = std::max(0, place - 1) / static_cast<double>(points);
  double right = std::min(points, place + 1) / static_cast<double>(points);
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 40; ++i) {
    const double first = right - golden * (right - left);
    const double second = left + golden * (right - left);
    if (function(at(first)) < function(at(second))) {
      left = first;
    } else {
      right = second;
    }
  }
  const double omega = at((left + right) / 2);
  const double refined = function(omega);
  return refined > value ? Extreme{refined, omega} : Extreme{value, at(static_cast<double>(place) / points)};
}

// Every omega at which |L| = 1, and up to `fast` at which L is real, between neighbours of a grid of two hundred points
// per decade.
template <typename Found>
void scan(const FractionalTransferFunction& loop, double from, double to, double fast, const Found& found) {
  const int points = static_cast<int>(200 * std::log10(to / from));
  const auto root = [](const auto& function, double left, double right) {
    const bool rises = function(left) < 0;
    for (int i = 0; i < 60; ++i) {
      const double middle = std::sqrt(left * right);
      ((function(middle) < 0) == rises ? left : right) = middle;
    }
    return std::sqrt(left * right);
  };
  const auto log_gain = [&](double omega) { return std::log(std::abs(loop.response(omega))); };
  const auto imaginary = [&](double omega) { return loop.response(omega).imag(); };
  double before = from;
  for (int i = 1; i <= points; ++i) {
    const double omega = from * std::pow(to / from, static_cast<double>(i) / points);
    if (log_gain(before) * log_gain(omega) <= 0) found(root(log_gain, before, omega), true);
    if (omega < fast && imaginary(before) * imaginary(omega) < 0) found(root(imaginary, before, omega), false);
    before = omega;
  }
}

}  // namespace

void describe_loop(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options, double reference, TuningResult& result) {
  const FractionalTransferFunction controller =
      controller_transfer_function(result.gains, options.derivative_filter_time);
  const FractionalTransferFunction loop(product(plant.numerator(), controller.numerator()),
                                        product(plant.denominator(), controller.denominator()), plant.delay());
  result.closed_loop = analyse_closed_loop(loop).stability;
  // Where dead time turns L by more than half a radian from point to point of the search below, the worst phase counts.
  const double fast = plant.delay() > 0 ? 0.5 / (0.0116 * plant.delay()) : infinity;
  const auto sensitivity = [&](double omega) {
    const Complex value = loop.response(omega);
    return omega > fast ? 1 / std::max(1 - std::abs(value), 1e-9) : 1 / std::abs(1.0 + value);
  };
  const auto complementary = [&](double omega) { return std::abs(loop.response(omega)) * sensitivity(omega); };
  const double lowest = reference * 1e-5;
  const double highest = reference * 1e5;
  const Extreme s = largest(sensitivity, lowest, highest);
  const Extreme t = largest(complementary, lowest, highest);
  result.max_sensitivity = s.value;
  result.omega_max_sensitivity = s.omega;
  result.max_complementary_sensitivity = t.value;
  result.omega_max_complementary_sensitivity = t.omega;

  result.crossover = result.phase_margin = result.phase_slope = nothing;
  result.gain_margin = infinity;
  double nearest = infinity;
  scan(loop, lowest, highest, fast, [&](double omega, bool is_crossover) {
    const Complex value = loop.response(omega);
    if (!is_crossover) {
      if (value.real() < 0 && std::abs(value) < 1)
        result.gain_margin = std::min(result.gain_margin, 1 / std::abs(value));
      return;
    }
    const double distance = asked.crossover ? std::abs(std::log(omega / *asked.crossover)) : 1 / omega;
    if (distance >= nearest) return;
    nearest = distance;
    result.crossover = omega;
    result.phase_margin = std::remainder(std::arg(value) + pi, 2 * pi);
    result.phase_slope = log_slope(loop, omega).imag();
  });
  // Beyond, every phase comes soon.
  if (fast < highest) result.gain_margin = std::min(result.gain_margin, 1 / std::abs(loop.response(fast)));

  const auto line = [&](const std::string& name, double value, double reached, bool met) {
    result.specification.push_back({name, value, reached, met});
  };
  constexpr double degree = 180 / pi;
  // What is solved for holds to rounding amplified by the conditioning of three equations.
  constexpr double solved = 1e-6;
  // Bounds are kept on a grid of thirty points per decade; between them a peak may be this much higher.
  constexpr double between = 1.002;
  if (asked.crossover) {
    line("crossover, rad/s", *asked.crossover, result.crossover,
         std::abs(result.crossover / *asked.crossover - 1) < solved);
  }
  if (asked.phase_margin) {
    line("phase margin, deg", *asked.phase_margin * degree, result.phase_margin * degree,
         std::abs(result.phase_margin - *asked.phase_margin) < solved);
  }
  if (asked.flat_phase) {
    line("phase slope, deg per e-fold", 0, result.phase_slope * degree, std::abs(result.phase_slope) < 1e-5);
  }
  const auto bound = [&](const std::string& name, double value, double reached) {
    line(name, value, reached, reached <= value * between);
  };
  if (std::isfinite(asked.max_sensitivity)) bound("max |S|", asked.max_sensitivity, result.max_sensitivity);
  if (std::isfinite(asked.max_complementary_sensitivity)) {
    bound("max |T|", asked.max_complementary_sensitivity, result.max_complementary_sensitivity);
  }
  if (asked.high_frequency) {
    const double from = asked.high_frequency->omega;
    bound("|T| from " + number_text(from) + " rad/s on", asked.high_frequency->gain,
          largest(complementary, from, std::max(highest, 1e3 * from)).value);
  }
  if (asked.low_frequency) {
    const double to = asked.low_frequency->omega;
    bound("|S| up to " + number_text(to) + " rad/s", asked.low_frequency->gain,
          largest(sensitivity, std::min(lowest, 1e-3 * to), to).value);
  }
  result.iae = result.itae = nothing;
  if (options.horizon > 0 && result.closed_loop == Stability::stable) {
    constexpr int samples = 4000;
    const auto with = [&](int count) {
      return LoopSimulation(plant, options.horizon, options.load_step, count)(result.gains,
                                                                              options.derivative_filter_time);
    };
    const ErrorIntegrals coarse = with(samples);
    const ErrorIntegrals fine = with(2 * samples);
    result.iae = 2 * fine.iae - coarse.iae;
    result.itae = 2 * fine.itae - coarse.itae;
  }
}

}  // namespace frac::detail
