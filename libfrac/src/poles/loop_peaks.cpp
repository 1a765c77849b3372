// SPDX-License-Identifier: BSD-3-Clause
#include "loop_peaks.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "frequency_axis.hpp"
#include "laplace_image.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Dead time is followed until it has turned L by this many radians.
constexpr double most_turn = 600;
constexpr double turn_between_points = 0.3;

// |S| and |T| for L = c s^order, order >= 0 towards infinity or <= 0 towards 0 where |L| does not vanish.
struct Limit {
  double sensitivity;
  double complementary;
};
Limit limit(double gain, double order, double outward, bool any_phase) {
  if (std::abs(order) > 1e-13) return order * outward < 0 ? Limit{1, 0} : Limit{0, 1};
  if (any_phase) gain = -std::abs(gain);
  const double difference = std::abs(1 + gain);
  return {1 / difference, std::abs(gain) / difference};
}

void keep_larger(PeakGain& best, double gain, double omega) {
  if (gain > best.gain) best = {gain, omega};
}

}  // namespace

LoopPeaks loop_peaks(const FractionalTransferFunction& loop, double from, double to) {
  const LaplaceImage image(numerator_of(loop), denominator_of(loop));
  const double delay = loop.delay();
  const FrequencyAxis axis(image, delay);
  LoopPeaks result{{0, 0}, {0, 0}};
  const auto add_limit = [&](const PowerTerm& top, const PowerTerm& bottom, double outward, bool late, double omega) {
    const Limit each = limit(top.coefficient / bottom.coefficient, top.order - bottom.order, outward, late);
    keep_larger(result.sensitivity, each.sensitivity, omega);
    keep_larger(result.complementary, each.complementary, omega);
  };
  if (from == 0) add_limit(loop.numerator().back(), loop.denominator().back(), -1, false, 0);
  if (to == infinity) add_limit(loop.numerator().front(), loop.denominator().front(), 1, delay > 0, infinity);

  // Beyond these ends L is its leading term to a few parts in a million.
  constexpr double margin = 12;
  const double corner = delay > 0 ? -std::log(delay) : image.lowest_corner();
  const double lowest = std::min({image.lowest_corner(), corner}) - margin;
  const double highest = std::max({image.highest_corner(), corner}) + margin;
  const double first = from > 0 ? std::log(from) : std::min(lowest, std::isfinite(to) ? std::log(to) - margin : lowest);
  const double last =
      std::isfinite(to) ? std::log(to) : std::max(highest, from > 0 ? std::log(from) + margin : highest);
  std::vector<double> points{first};
  const double followed = delay > 0 ? std::log(most_turn / delay) : infinity;
  for (const double u : axis.breakpoints(first, last)) {
    const double before = points.back();
    if (delay > 0 && u <= followed) {
      const double turn = delay * (std::exp(u) - std::exp(before));
      const int pieces = 1 + static_cast<int>(turn / turn_between_points);
      for (int k = 1; k < pieces; ++k) points.push_back(before + (u - before) * k / pieces);
    }
    if (u > before) points.push_back(u);
  }

  const auto consider = [&](double u) {
    const Complex value = axis.value(u);
    const double size = std::abs(value);
    const double difference = u > followed ? std::max(1 - size, 1e-9) : std::abs(1.0 + value);
    keep_larger(result.sensitivity, 1 / difference, std::exp(u));
    keep_larger(result.complementary, size / difference, std::exp(u));
  };
  // d ln|S|/du and d ln|T|/du.
  const auto sensitivity_slope = [&](double u) {
    const Complex value = axis.value(u);
    return -(value / (1.0 + value) * axis.log_slope(u)).real();
  };
  const auto complementary_slope = [&](double u) { return (axis.log_slope(u) / (1.0 + axis.value(u))).real(); };
  for (std::size_t i = 0; i < points.size(); ++i) {
    consider(points[i]);
    if (i + 1 == points.size() || points[i + 1] > followed) continue;
    const auto refine = [&](const auto& slope) {
      if (slope(points[i]) > 0 && slope(points[i + 1]) <= 0) consider(bisected(slope, points[i], points[i + 1]));
    };
    refine(sensitivity_slope);
    refine(complementary_slope);
  }
  return result;
}

}  // namespace frac::detail
