// SPDX-License-Identifier: BSD-3-Clause
#include "loop_description.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/number_text.hpp"
#include "frac/model/algebra.hpp"
#include "loop.hpp"
#include "poles/loop_peaks.hpp"

namespace frac::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// The crossover nearest to what was asked, else the highest, and the others.
void describe_crossovers(const std::vector<Crossover>& crossovers, const LoopSpecification& asked,
                         const FractionalTransferFunction& loop, TuningResult& result) {
  result.crossover = result.phase_margin = result.phase_slope = nothing;
  double nearest = infinity;
  for (const Crossover& each : crossovers) {
    const double distance = asked.crossover ? std::abs(std::log(each.omega / *asked.crossover)) : 1 / each.omega;
    if (distance >= nearest) continue;
    nearest = distance;
    result.crossover = each.omega;
    result.phase_margin = each.margin;
    result.phase_slope = log_slope(loop, each.omega).imag();
  }
  for (const Crossover& each : crossovers) {
    if (each.omega != result.crossover) result.other_crossovers.push_back(each);
  }
}

}  // namespace

void describe_loop(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options, TuningResult& result) {
  const FractionalTransferFunction controller =
      controller_transfer_function(result.gains, options.derivative_filter_time);
  const FractionalTransferFunction loop = plant * controller;
  result.closed_loop = analyse_closed_loop(loop).stability;
  const LoopPeaks peaks = loop_peaks(loop, 0, infinity);
  result.max_sensitivity = peaks.sensitivity.gain;
  result.omega_max_sensitivity = peaks.sensitivity.omega;
  result.max_complementary_sensitivity = peaks.complementary.gain;
  result.omega_max_complementary_sensitivity = peaks.complementary.omega;
  const Margins exact = margins(loop);
  result.gain_margin = exact.gain_margin;
  describe_crossovers(exact.phase, asked, loop, result);

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
          loop_peaks(loop, from, infinity).complementary.gain);
  }
  if (asked.low_frequency) {
    const double to = asked.low_frequency->omega;
    bound("|S| up to " + number_text(to) + " rad/s", asked.low_frequency->gain,
          loop_peaks(loop, 0, to).sensitivity.gain);
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
