// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>
#include <random>

namespace frac::detail {

// Draws that are the same on every platform, unlike those of the distributions of <random>.

/// Uniform in [0, 1), from the generator's top 53 bits.
[[nodiscard]] inline double uniform_draw(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1p-53;
}

/// Normal, of mean 0 and variance 1 (Box, Muller).
[[nodiscard]] inline double normal_draw(std::mt19937_64& generator) {
  const double radius = std::sqrt(-2 * std::log(1 - uniform_draw(generator)));
  return radius * std::cos(2 * std::numbers::pi * uniform_draw(generator));
}

}  // namespace frac::detail
