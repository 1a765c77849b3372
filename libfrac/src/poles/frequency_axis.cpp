// SPDX-License-Identifier: BSD-3-Clause
#include "frequency_axis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double quarter_turn = std::numbers::pi / 2;

void add_about(const std::vector<RootCluster>& roots, std::vector<double>& points) {
  for (const RootCluster& root : roots) {
    const double distance = std::max(1e-12, std::abs(root.log_s.imag() - quarter_turn));
    const double middle = root.log_s.real();
    points.push_back(middle);
    for (double offset = distance / 4; offset < 2; offset *= 1.3) {
      points.push_back(middle - offset);
      points.push_back(middle + offset);
    }
  }
}

}  // namespace

Complex FrequencyAxis::value(double u) const {
  return image_.value({u, quarter_turn}, Complex(0, -delay_ * std::exp(u)));
}

double FrequencyAxis::log_gain(double u) const {
  const ScaledSum top = scaled_sum(image_.numerator(), {u, quarter_turn});
  const ScaledSum bottom = scaled_sum(image_.denominator(), {u, quarter_turn});
  return std::log(std::abs(top.value / bottom.value)) + top.scale - bottom.scale;
}

Complex FrequencyAxis::log_slope(double u) const {
  const ScaledSum top = scaled_sum(image_.numerator(), {u, quarter_turn});
  const ScaledSum bottom = scaled_sum(image_.denominator(), {u, quarter_turn});
  return top.slope / top.value - bottom.slope / bottom.value - Complex(0, delay_ * std::exp(u));
}

std::vector<double> FrequencyAxis::breakpoints(double first, double last) const {
  std::vector<double> points;
  constexpr double spacing = 0.02;
  for (double u = first; u < last; u += spacing) points.push_back(u);
  points.push_back(last);
  add_about(image_.poles().clusters, points);
  add_about(power_sum_roots(image_.numerator(), 1.5 * std::numbers::pi).clusters, points);
  std::sort(points.begin(), points.end());
  std::erase_if(points, [&](double u) { return u < first || u > last; });
  return points;
}

}  // namespace frac::detail
