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
  // The dead time is the last parameter; the inversion is that of the rest.
  std::vector<double> parameters = system.parameters;
  if (system.delay > 0) {
    t -= parameters.back();
    parameters.back() = 0;
  }
  if (t < 0) return 0;
  // An input held from a sample on acts at that sample: the limit from the right.
  t = std::fmax(t, 1e-30);
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

std::vector<double> respond(const Record& record, const std::function<double(double)>& response) {
  std::vector<double> output(record.time.size(), 0);
  for (const auto& [first, height] : record.steps) {
    for (std::size_t i = first; i < output.size(); ++i) {
      output[i] += height * response(record.time[i] - record.time[first]);
    }
  }
  return output;
}

Record record(const System& system, const RecordSetting& setting, RandomNumbers& random) {
  Record result;
  const double length = random.log_uniform(5, 14);
  const auto count = static_cast<std::size_t>(setting.samples);
  result.steps = {{0, 1}};
  const auto later = [&](double low, double high) {
    return static_cast<std::size_t>(random.uniform(low, high) * static_cast<double>(count));
  };
  if (setting.input == "pulse") {
    result.steps.emplace_back(later(0.3, 0.6), -1);
  } else if (setting.input == "staircase") {
    double level = 1;
    for (const double part : {0.25, 0.5, 0.75}) {
      const std::size_t sample = later(part - 0.1, part + 0.1);
      const double next = random.uniform(-1, 1);
      result.steps.emplace_back(sample, next - level);
      level = next;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    result.time.push_back(length * static_cast<double>(i) / static_cast<double>(count - 1));
  }
  result.input = respond(result, [](double) { return 1.0; });
  result.exact = respond(result, [&](double t) { return step_response(system, t); });
  result.output = result.exact;
  double largest = 0;
  for (const double y : result.exact) largest = std::fmax(largest, std::abs(y));
  result.sigma = setting.level * largest;
  result.correlation = setting.noise == "correlated" ? random.uniform(0.5, 0.9) : 0;
  double error = random.normal();
  for (double& y : result.output) {
    error = result.correlation * error + std::sqrt(1 - result.correlation * result.correlation) * random.normal();
    y += result.sigma * error;
  }
  return result;
}

}  // namespace judging
