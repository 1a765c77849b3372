// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

namespace support {

/// Largest value of a function of omega: on a grid whose points lie `step` apart in ln omega, and again a thousand
/// times as dense between the neighbours of the largest one.  Beside a peak of quality Q the first grid misses up to (Q
/// step)^2/2 of it, the second a millionth of that.
template <class Function>
double dense_maximum(const Function& function, double from, double to, double step) {
  double largest = 0;
  double at = from;
  for (double omega = from; omega <= to; omega *= 1 + step) {
    const double value = function(omega);
    if (value > largest) {
      largest = value;
      at = omega;
    }
  }
  for (int i = -1000; i <= 1000; ++i) largest = std::max(largest, function(at * std::pow(1 + step, i / 1000.0)));
  return largest;
}

}  // namespace support
