// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "laplace_image.hpp"

namespace frac::detail {

/// G on the positive imaginary axis as a function of u = ln omega.
class FrequencyAxis {
 public:
  FrequencyAxis(const LaplaceImage& image, double delay) : image_(image), delay_(delay) {}

  [[nodiscard]] std::complex<double> value(double u) const;
  [[nodiscard]] double log_gain(double u) const;
  /// d ln|G| / du + i d arg G / du.
  [[nodiscard]] std::complex<double> log_slope(double u) const;

  /// Points of u between the end values, dense about each pole and zero near the axis: between neighbours gain and
  /// phase have one extremum at most.
  [[nodiscard]] std::vector<double> breakpoints(double first, double last) const;

 private:
  const LaplaceImage& image_;
  double delay_;
};

/// Root of f between a and b, where f has different signs, to the last bits.
template <typename Function>
[[nodiscard]] double bisected(const Function& f, double a, double b) {
  const bool rising = f(a) < 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = a + (b - a) / 2;
    if (middle == a || middle == b) break;
    ((f(middle) < 0) == rising ? a : b) = middle;
  }
  return a + (b - a) / 2;
}

}  // namespace frac::detail
