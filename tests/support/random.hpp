// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>

namespace support {

/// Seeded draws that are the same on every standard library (the distributions of <random> are not).
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// In [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double uniform(double lower, double upper) { return lower + (upper - lower) * unit(); }
  double log_uniform(double lower, double upper) { return lower * std::exp(std::log(upper / lower) * unit()); }
  /// In 0 .. count-1.
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  /// Standard normal, by Box and Muller.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - unit()));
    return radius * std::cos(2 * 3.14159265358979323846 * unit());
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace support
