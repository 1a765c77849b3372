// SPDX-License-Identifier: BSD-3-Clause
#include "noise_floor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "base/median.hpp"
#include "identification/data/local_curve.hpp"

namespace frac::detail {
namespace {

/// A weighted sum of values at neighbouring points, which is small for a smooth curve.
struct Change {
  double size;
  std::array<std::pair<std::size_t, double>, 1 + LocalCurve::most_neighbours> shares;  // of its variance, by point
  std::size_t count;
};

/// One change for each part that is looked at.
void add(std::vector<Change>& all, Component component, const Change& shape, std::complex<double> size) {
  for (const bool real : {true, false}) {
    if (component == (real ? Component::imaginary : Component::real)) continue;
    all.push_back(shape);
    all.back().size = real ? size.real() : size.imag();
  }
}

/// Distances of residuals from the line through both neighbours.
std::vector<Change> changes(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                            Component component) {
  std::vector<Change> result;
  const auto& omega = data.omega();
  for (std::size_t i = 1; i + 1 < omega.size(); ++i) {
    const double width = std::log(omega[i + 1] / omega[i - 1]);
    const double right = width > 0 ? std::log(omega[i] / omega[i - 1]) / width : 0.5, left = 1 - right;
    const auto rest = [&](std::size_t k) { return model[k] - data.value()[k]; };
    add(result, component, {0, {{{i, 1}, {i - 1, left * left}, {i + 1, right * right}}}, 3},
        rest(i) - left * rest(i - 1) - right * rest(i + 1));
  }
  return result;
}

/// Distances of values from the curve through their neighbours.
std::vector<Change> changes(const FrequencyResponseData& data, Component component) {
  std::vector<double> log_omega;
  std::vector<std::size_t> all;
  for (const double omega : data.omega()) {
    all.push_back(log_omega.size());
    log_omega.push_back(std::log(omega));
  }
  std::vector<Change> result;
  for (std::size_t i = 2; i + 2 < all.size(); ++i) {
    const LocalCurve curve = local_curve(log_omega, all, i);
    if (!std::isfinite(curve.noise)) continue;  // among repeats
    Change change{0, {{{i, 1}}}, 1};
    std::complex<double> size = data.value()[i];
    for (std::size_t k = 0; k < curve.count; ++k) {
      size -= curve.weight[k] * data.value()[curve.neighbour[k]];
      change.shares[change.count++] = {curve.neighbour[k], curve.weight[k] * curve.weight[k]};
    }
    add(result, component, change, size);
  }
  return result;
}

/// Logarithm of the likelihood of the changes at its best r.
double likelihood(const std::vector<Change>& all, const std::vector<double>& square, double floor) {
  constexpr double degrees = 4;
  std::vector<double> ratio;  // squared size over its variance for r = 1
  double logarithm = 0;
  for (const Change& each : all) {
    double variance = 0;
    for (std::size_t k = 0; k < each.count; ++k) {
      variance += each.shares[k].second * (square[each.shares[k].first] + floor * floor);
    }
    ratio.push_back(each.size * each.size / variance);
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

/// @param size  of the values, whose noise is sought
double floor_of(const FrequencyResponseData& data, std::span<const std::complex<double>> size,
                std::vector<Change> all) {
  // In units of the largest value, so that no square overflows.
  double largest = 0;
  for (const std::complex<double> each : data.value()) largest = std::max(largest, std::abs(each));
  std::vector<double> square;
  double smallest = largest;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double of_model = std::max(std::abs(size[i]), 1e-12 * largest);
    smallest = std::min({smallest, of_model, std::max(std::abs(data.value()[i]), 1e-12 * largest)});
    square.push_back(std::pow(of_model / largest, 2));
  }
  std::vector<double> changed;
  for (Change& each : all) {
    each.size /= largest;
    changed.push_back(each.size * each.size / square[each.shares[0].first]);
  }
  // Values that follow a curve to within rounding show no noise.
  constexpr double rounding = 1e-10;
  if (changed.empty() || !(median(changed) > rounding * rounding)) return 0;

  const double none = likelihood(all, square, 0);
  double best = 0, highest = none;
  const double first = std::log(smallest / largest / 10), last = std::log(30.0);
  const auto try_floor = [&](double log_floor) {
    const double floor = std::exp(log_floor), here = likelihood(all, square, floor);
    if (here <= highest) return;
    highest = here;
    best = floor;
  };
  // A likelihood has no finer structure than the floor's own uncertainty, which is no less than a twentieth.
  const int steps = static_cast<int>(last - first) + 1;
  for (int i = 0; i <= steps; ++i) try_floor(first + (last - first) * i / steps);
  if (best == 0) return 0;
  const double about = std::log(best);
  for (const double shift : {-0.75, -0.5, -0.25, 0.25, 0.5, 0.75}) try_floor(about + shift);
  const double near = std::log(best);
  for (const double shift : {-0.12, 0.12}) try_floor(near + shift);
  // A floor that is found where there is none is small and does little harm; one that is missed makes intervals wrong.
  constexpr double clearly = 2;
  return highest - none > clearly ? best * largest : 0;
}

bool tells_a_floor(const FrequencyResponseData& data, Component component) {
  constexpr std::size_t fewest = 12;
  return data.size() >= fewest && component != Component::magnitude && component != Component::phase;
}

}  // namespace

double noise_floor(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                   Component component) {
  return tells_a_floor(data, component) ? floor_of(data, model, changes(data, model, component)) : 0;
}

double noise_floor(const FrequencyResponseData& data, Component component) {
  return tells_a_floor(data, component) ? floor_of(data, data.value(), changes(data, component)) : 0;
}

}  // namespace frac::detail
