// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <initializer_list>
#include <vector>

namespace support {

/// What the multipliers of a motion, found by another method, say of its stability.
struct ExpectedStability {
  int outside = 0;                   // multipliers of modulus above 1
  std::complex<double> largest = 0;  // by modulus
  double next_to_circle = 1;         // least distance of a modulus from 1
};

/// @param known  multipliers that a cycle has in any case and its stability leaves out; of each the nearest is dropped
inline ExpectedStability expected_stability(std::vector<std::complex<double>> multipliers,
                                            std::initializer_list<double> known) {
  using Complex = std::complex<double>;
  for (const double value : known) {
    multipliers.erase(std::min_element(multipliers.begin(), multipliers.end(), [&](const Complex& a, const Complex& b) {
      return std::abs(a - value) < std::abs(b - value);
    }));
  }
  ExpectedStability expected;
  for (const Complex& multiplier : multipliers) {
    expected.outside += std::abs(multiplier) > 1;
    expected.next_to_circle = std::min(expected.next_to_circle, std::abs(std::abs(multiplier) - 1));
    if (std::abs(multiplier) > std::abs(expected.largest)) expected.largest = multiplier;
  }
  return expected;
}

}  // namespace support
