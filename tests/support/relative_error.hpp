// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <vector>

namespace support {

inline double relative_error(std::complex<double> value, std::complex<double> reference) {
  return std::abs(value - reference) / std::abs(reference);
}

inline std::vector<double> linear_grid(double lower, double upper, int count) {
  std::vector<double> grid;
  for (int i = 0; i < count; ++i) grid.push_back(lower + (upper - lower) * i / (count - 1));
  return grid;
}

/// `count` frequencies from lower to upper, equally spaced in logarithm, ends included.
inline std::vector<double> log_grid(double lower, double upper, int count) {
  std::vector<double> grid;
  for (int i = 0; i < count; ++i) grid.push_back(lower * std::exp(std::log(upper / lower) * i / (count - 1)));
  return grid;
}

}  // namespace support
