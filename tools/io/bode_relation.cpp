// SPDX-License-Identifier: BSD-3-Clause
#include "io/bode_relation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace io {

std::optional<double> departure_from_bode(const std::vector<double>& omega,
                                          const std::vector<std::complex<double>>& value) {
  constexpr std::size_t fewest = 6;
  // Most of the weight of Bode's integral lies within this ratio to either side.
  const double reach = 0.35 * std::numbers::ln10;
  const std::size_t count = omega.size();
  // A band that one stretch of slope fills says nothing.
  if (count < fewest || !(omega.front() > 0) || std::log(omega.back() / omega.front()) < std::numbers::ln10 ||
      std::any_of(value.begin(), value.end(), [](auto v) { return !(std::abs(v) > 0); }))
    return std::nullopt;
  // Sums up to a point of x, y = ln|Z|, x^2, x y and the phase.
  std::vector<std::array<double, 5>> sums(count + 1);
  std::vector<double> place(count);
  const double middle = std::log(omega[count / 2]), level = std::log(std::abs(value[count / 2]));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = place[i] = std::log(omega[i]) - middle, y = std::log(std::abs(value[i])) - level;
    const std::array<double, 5> terms{x, y, x * x, x * y, std::arg(value[i])};
    for (std::size_t k = 0; k < terms.size(); ++k) sums[i + 1][k] = sums[i][k] + terms[k];
  }
  double difference = 0, whole = 0;
  for (std::size_t i = 0, first = 0, last = 0; i < count; ++i) {
    const auto is_near = [&](std::size_t j) { return std::abs(place[j] - place[i]) <= reach; };
    while (!is_near(first)) ++first;
    while (last + 1 < count && is_near(last + 1)) ++last;
    const std::size_t begin = std::min(first, i - std::min<std::size_t>(i, 1));
    const std::size_t end = std::min(std::max(last, i + 1) + 1, count);
    const auto points = static_cast<double>(end - begin);
    const auto mean = [&](std::size_t k) { return (sums[end][k] - sums[begin][k]) / points; };
    const double spread = mean(2) - mean(0) * mean(0);
    if (!(spread > 1e-12)) continue;  // of one frequency: rounding of the sums
    const double expected = std::numbers::pi / 2 * (mean(3) - mean(0) * mean(1)) / spread, phase = mean(4);
    difference += (phase - expected) * (phase - expected);
    whole += phase * phase + expected * expected;
  }
  return whole > 0 ? std::optional(difference / whole) : std::nullopt;
}

}  // namespace io
