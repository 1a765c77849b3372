// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/step_figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/number_text.hpp"
#include "frac/time_response/loop_response.hpp"
#include "poles/laplace_image.hpp"

namespace frac {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr double tolerance = 1e-5;  // over the largest output
constexpr double band = 0.02;

double final_value_of(const FractionalTransferFunction& loop) {
  const double order = detail::order_at_origin(loop);
  if (order < 0) return 1;
  if (order > 0) return 0;
  const double gain = loop.numerator().back().coefficient / loop.denominator().back().coefficient;
  if (gain == -1) throw std::invalid_argument("step figures: 1 + L(0) is 0; the output has no final value");
  return gain / (1 + gain);
}

struct Curve {
  std::vector<double> time, output;
  double error;
};

// At count + 1 even instants.
Curve curve(const FractionalTransferFunction& loop, double from, double to, std::size_t count) {
  Curve result{{}, {}, 0};
  for (std::size_t i = 0; i <= count; ++i)
    result.time.push_back(from + (to - from) * static_cast<double>(i) / static_cast<double>(count));
  LoopResponse response = respond_closed_loop(loop, loop, ResponseInput{}, result.time, tolerance);
  result.output = std::move(response.output);
  result.error = response.error_estimate;
  return result;
}

}  // namespace

StepFigures step_figures(const FractionalTransferFunction& loop, double crossover) {
  if (!(crossover > 0 && std::isfinite(crossover))) {
    throw std::invalid_argument("step figures: crossover = " + detail::number_text(crossover) +
                                " rad/s; allowed is above 0, finite");
  }
  StepFigures figures{final_value_of(loop), 0, nothing, nothing, 0, 0};
  const double target = figures.final_value;
  if (target == 0) return {0, nothing, nothing, nothing, 0, 0};
  constexpr std::size_t coarse = 600, fine = 200;
  const auto is_outside = [&](double value) { return std::abs(value / target - 1) > band; };
  Curve whole;
  std::size_t last_outside = coarse;
  constexpr double longest = 150;
  for (double end = 30 / crossover + 3 * loop.delay(); true; end *= 4) {
    Curve longer = curve(loop, 0, end, coarse);
    // A slow loop with many dead times may lose its digits.
    if (!whole.time.empty() && longer.error > 0.1 * band * std::abs(target)) break;
    whole = std::move(longer);
    figures.end = end;
    last_outside = coarse;
    while (last_outside > 0 && !is_outside(whole.output[last_outside])) --last_outside;
    if (3 * last_outside < 2 * coarse || 4 * (end - 3 * loop.delay()) * crossover > longest) break;
  }
  figures.error_estimate = whole.error / std::abs(target);
  const auto around = [&](std::size_t i) {
    return curve(loop, whole.time[i > 0 ? i - 1 : 0], whole.time[std::min(i + 1, coarse)], fine);
  };
  const auto rise = [&](double value) { return value / target - 1; };
  const auto higher = [&](double a, double b) { return rise(a) < rise(b); };
  const auto peak = static_cast<std::size_t>(std::max_element(whole.output.begin(), whole.output.end(), higher) -
                                             whole.output.begin());
  if (rise(whole.output[peak]) > 10 * figures.error_estimate && peak < coarse) {
    const Curve close = around(peak);
    const auto highest = std::max_element(close.output.begin(), close.output.end(), higher);
    figures.overshoot = rise(*highest);
    figures.peak_time = close.time[static_cast<std::size_t>(highest - close.output.begin())];
  }
  if (last_outside < coarse) {
    const Curve close = curve(loop, whole.time[last_outside], whole.time[last_outside + 1], fine);
    std::size_t i = fine;
    while (i > 0 && !is_outside(close.output[i])) --i;
    figures.settling_time = close.time[i];
    if (i < fine) {
      const double from = std::abs(rise(close.output[i])) - band, to = band - std::abs(rise(close.output[i + 1]));
      if (from + to > 0) figures.settling_time += (close.time[i + 1] - close.time[i]) * from / (from + to);
    }
  }
  return figures;
}

}  // namespace frac
