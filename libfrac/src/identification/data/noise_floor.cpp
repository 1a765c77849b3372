// SPDX-License-Identifier: BSD-3-Clause
#include "noise_floor.hpp"

#include <algorithm>
#include <cmath>

namespace frac::detail {
namespace {

/// Distance of a residual from the line through its neighbours, and the shares of three variances in its own.
struct Change {
  double distance;
  double left, right;  // shares of the neighbours; its own is 1
  std::size_t point;
};

std::vector<Change> changes(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                            Component component) {
  std::vector<Change> result;
  const auto& omega = data.omega();
  for (std::size_t i = 1; i + 1 < omega.size(); ++i) {
    const double width = std::log(omega[i + 1] / omega[i - 1]);
    const double right = width > 0 ? std::log(omega[i] / omega[i - 1]) / width : 0.5, left = 1 - right;
    const auto rest = [&](std::size_t k) { return model[k] - data.value()[k]; };
    const std::complex<double> distance = rest(i) - left * rest(i - 1) - right * rest(i + 1);
    const auto add = [&](double part) { result.push_back({part, left * left, right * right, i}); };
    if (component != Component::imaginary) add(distance.real());
    if (component != Component::real) add(distance.imag());
  }
  return result;
}

/// Logarithm of the likelihood of the changes at its best r.
double likelihood(const std::vector<Change>& all, const std::vector<double>& square, double floor) {
  constexpr double degrees = 4;
  std::vector<double> ratio;  // squared distance over its variance for r = 1
  double logarithm = 0;
  for (const Change& each : all) {
    const double additive = floor * floor;
    const double variance = square[each.point] + additive + each.left * (square[each.point - 1] + additive) +
                            each.right * (square[each.point + 1] + additive);
    ratio.push_back(each.distance * each.distance / variance);
    logarithm -= 0.5 * std::log(variance);
  }
  // The scale that fits best, each time nearer (expectation and maximisation).
  double scale = 0;
  for (const double each : ratio) scale += each / static_cast<double>(ratio.size());
  for (int pass = 0; pass < 12; ++pass) {
    double sum = 0;
    for (const double each : ratio) sum += (degrees + 1) / (degrees + each / scale) * each;
    scale = sum / static_cast<double>(ratio.size());
  }
  for (const double each : ratio) {
    logarithm -= 0.5 * std::log(scale) + 0.5 * (degrees + 1) * std::log1p(each / scale / degrees);
  }
  return logarithm;
}

}  // namespace

double noise_floor(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                   Component component) {
  constexpr std::size_t fewest = 12;
  if (data.size() < fewest || component == Component::magnitude || component == Component::phase) return 0;
  // In units of the largest value, so that no square overflows.
  double largest = 0;
  for (const std::complex<double> each : data.value()) largest = std::max(largest, std::abs(each));
  std::vector<double> square;
  double smallest = largest;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double size = std::max(std::abs(model[i]), 1e-12 * largest);
    smallest = std::min({smallest, size, std::max(std::abs(data.value()[i]), 1e-12 * largest)});
    square.push_back(std::pow(size / largest, 2));
  }
  std::vector<Change> all = changes(data, model, component);
  std::vector<double> changed;
  for (Change& each : all) {
    each.distance /= largest;
    changed.push_back(each.distance * each.distance / square[each.point]);
  }
  // Of a fit that meets most points there is no noise to learn from.
  constexpr double rounding = 1e-10;
  const auto middle = changed.begin() + static_cast<std::ptrdiff_t>(changed.size() / 2);
  std::nth_element(changed.begin(), middle, changed.end());
  if (!(*middle > rounding * rounding)) return 0;

  const double none = likelihood(all, square, 0);
  double best = 0, highest = none;
  constexpr double per_e_fold = 5;
  const double first = std::log(smallest / largest / 10), last = std::log(30.0);
  const int steps = static_cast<int>((last - first) * per_e_fold) + 1;
  for (int i = 0; i <= steps; ++i) {
    const double floor = std::exp(first + (last - first) * i / steps);
    const double here = likelihood(all, square, floor);
    if (here <= highest) continue;
    highest = here;
    best = floor;
  }
  // A floor that is seen where there is none is a small one and costs little; one that is missed spoils intervals.
  constexpr double clearly = 2;
  return highest - none > clearly ? best * largest : 0;
}

}  // namespace frac::detail
