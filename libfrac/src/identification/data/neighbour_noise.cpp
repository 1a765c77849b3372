// SPDX-License-Identifier: BSD-3-Clause
#include "neighbour_noise.hpp"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/median.hpp"

namespace frac::detail {

double neighbour_noise(std::span<const double> x, std::span<const double> y) {
  std::vector<double> distance;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double before = x[i] - x[i - 1], after = x[i + 1] - x[i];
    const double share = before + after > 0 ? before / (before + after) : 0.5;
    const double line = y[i - 1] * (1 - share) + y[i + 1] * share;
    distance.push_back(std::abs(y[i] - line) / std::sqrt(1 + share * share + (1 - share) * (1 - share)));
  }
  return robust_deviation(std::move(distance));
}

}  // namespace frac::detail
