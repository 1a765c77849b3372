// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "laplace_image.hpp"

namespace frac::detail {

/// G on the positive imaginary axis as a function of u = ln omega, with the phases of its terms computed once.
class FrequencyAxis {
 public:
  FrequencyAxis(const LaplaceImage& image, double delay);

  [[nodiscard]] std::complex<double> value(double u) const;
  [[nodiscard]] double log_gain(double u) const;
  /// d ln|G| / du + i d arg G / du.
  [[nodiscard]] std::complex<double> log_slope(double u) const;

  /// Points of u between the end values, dense about each pole and zero near the axis: between neighbours gain and
  /// phase have one extremum at most.
  [[nodiscard]] std::vector<double> breakpoints(double first, double last) const;

 private:
  struct Term {
    double log_size;
    double order;
    std::complex<double> phase;  // of coefficient (j omega)^order
  };
  struct Sum {
    std::vector<Term> terms;
    double power;  // negative below the line
  };
  // Sum of the terms over e^scale.
  struct Value {
    std::complex<double> value;
    std::complex<double> slope;
    double scale;
  };
  static Value evaluated(const Sum& sum, double u);

  const LaplaceImage& image_;
  double delay_;
  std::vector<Sum> sums_;
};

/// How G without dead time nears its leading term c s^q towards one end of the axis.
class AxisLimit {
 public:
  enum class End { low, high };
  AxisLimit(const LaplaceImage& image, End end);

  /// From u outwards |G| over |leading term| rises, falls or stays, without an extremum.
  [[nodiscard]] bool gain_is_monotone(double u) const;
  /// From u outwards the phase of G without and with the dead time stays on one side of that of the leading term.
  /// Dead time counts at the low end alone.
  [[nodiscard]] bool phase_keeps_side(double u, double delay) const;

 private:
  // coefficient x^order, x the distance from the end: e^u or e^-u.
  struct Part {
    double order;
    double coefficient;
    double modulus;  // of what it was formed from
  };
  struct Factor {
    std::vector<Part> square;  // |sum|^2 over that of its leading term, less 1
    std::vector<Part> turn;    // imaginary part of the sum over its leading term
    double power;              // negative below the line
  };
  [[nodiscard]] double log_x(double u) const { return end_ == End::low ? u : -u; }

  End end_;
  double order_ = 0;
  std::vector<Factor> factors_;
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
