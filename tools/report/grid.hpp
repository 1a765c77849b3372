// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace report {

/// count >= 2 points in equal ratios, both ends hit exactly.
[[nodiscard]] inline std::vector<double> logarithmic_grid(double from, double to, std::size_t count) {
  std::vector<double> grid(count);
  for (std::size_t i = 0; i < count; ++i) {
    grid[i] = from * std::pow(to / from, static_cast<double>(i) / static_cast<double>(count - 1));
  }
  grid.front() = from;
  grid.back() = to;
  return grid;
}

/// count >= 2 points in equal steps, both ends hit exactly.
[[nodiscard]] inline std::vector<double> linear_grid(double from, double to, std::size_t count) {
  std::vector<double> grid(count);
  for (std::size_t i = 0; i < count; ++i) {
    grid[i] = from + (to - from) * static_cast<double>(i) / static_cast<double>(count - 1);
  }
  grid.back() = to;
  return grid;
}

}  // namespace report
