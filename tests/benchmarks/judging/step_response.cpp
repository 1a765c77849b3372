// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/judging/step_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace judging {

bool has_record(const Kind& kind) {
  static constexpr std::array<std::string_view, 31> names = {"lag",
                                                             "two-lags",
                                                             "three-lags-near",
                                                             "equal-lags",
                                                             "lags-in-geometric-row",
                                                             "underdamped",
                                                             "three-lags-two-zeros",
                                                             "lag-and-dead-time",
                                                             "lags-and-dead-time",
                                                             "zero-in-the-right-half-plane",
                                                             "integrator-with-lags",
                                                             "three-arcs",
                                                             "uniform-ladder",
                                                             "recursive-ladder",
                                                             "all-pass-behind-a-lag",
                                                             "nearly-cancelling-pole-and-zero",
                                                             "fractional-lag",
                                                             "fractional-lag-near-whole-order",
                                                             "fractional-lag-and-dead-time",
                                                             "cole-davidson",
                                                             "havriliak-negami",
                                                             "warburg-short-with-resistance",
                                                             "mass-with-fractional-damper",
                                                             "fractional-lead",
                                                             "lead-to-a-power",
                                                             "half-space-diffusion",
                                                             "heated-rod",
                                                             "distributed-order",
                                                             "product-of-fractional-lags",
                                                             "closed-loop-of-fractional-plant",
                                                             "fractional-solid"};
  return std::find(names.begin(), names.end(), kind.name) != names.end();
}

double step_response(const System& system, double t) {
  t -= system.delay;
  if (t < 0) return 0;
  // An input held from a sample on acts at that sample: the limit from the right.
  t = std::fmax(t, 1e-30);
  std::vector<double> parameters = system.parameters;
  // The dead time is the last parameter, and is in t already.
  if (system.delay > 0) parameters.back() = 0;
  constexpr int nodes = 32;
  const double radius = 2.0 * nodes / (5 * t);
  const auto transform = [&](Complex s) { return system.response(parameters, system.order, s) / s; };
  double sum = 0.5 * std::exp(radius * t) * transform(radius).real();
  for (int k = 1; k < nodes; ++k) {
    const double theta = k * std::numbers::pi / nodes;
    const double cotangent = std::cos(theta) / std::sin(theta);
    const Complex s = radius * theta * Complex(cotangent, 1);
    const double turn = theta + (theta * cotangent - 1) * cotangent;
    sum += (std::exp(s * t) * transform(s) * Complex(1, turn)).real();
  }
  return sum * radius / nodes;
}

Record record(const System& system, const RecordSetting& setting, RandomNumbers& random) {
  Record result;
  const double length = random.log_uniform(5, 14);
  const auto count = static_cast<std::size_t>(setting.samples);
  std::vector<std::size_t> changes = {0};
  std::vector<double> levels = {1};
  const auto later = [&](double low, double high) {
    return static_cast<std::size_t>(random.uniform(low, high) * static_cast<double>(count));
  };
  if (setting.input == "pulse") {
    changes.push_back(later(0.3, 0.6));
    levels.push_back(0);
  } else if (setting.input == "staircase") {
    for (const double part : {0.25, 0.5, 0.75}) {
      changes.push_back(later(part - 0.1, part + 0.1));
      levels.push_back(random.uniform(-1, 1));
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    result.time.push_back(length * static_cast<double>(i) / static_cast<double>(count - 1));
    double input = 0;
    double output = 0;
    for (std::size_t k = 0; k < changes.size(); ++k) {
      if (i < changes[k]) break;
      input = levels[k];
      const double jump = levels[k] - (k == 0 ? 0 : levels[k - 1]);
      output += jump * step_response(system, result.time[i] - result.time[changes[k]]);
    }
    result.input.push_back(input);
    result.output.push_back(output);
  }
  double largest = 0;
  for (const double y : result.output) largest = std::fmax(largest, std::abs(y));
  const double correlation = setting.noise == "correlated" ? random.uniform(0.5, 0.9) : 0;
  double error = random.normal();
  for (double& y : result.output) {
    error = correlation * error + std::sqrt(1 - correlation * correlation) * random.normal();
    if (setting.level > 0) y += setting.level * largest * error;
  }
  return result;
}

}  // namespace judging
