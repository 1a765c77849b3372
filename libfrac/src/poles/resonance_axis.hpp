// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "laplace_image.hpp"

namespace frac::detail {

/// |G| on the positive imaginary axis about one frequency, accurate beside a pole however close to the axis it lies.
/// Each sum is known at the middle in quadruple precision, and the change from there term by term,
/// c (j omega)^q (e^(q offset) - 1), so that nothing cancels but what is small at the pole itself.
class ResonanceAxis {
 public:
  /// @param middle  ln omega
  ResonanceAxis(const LaplaceImage& image, double middle);

  [[nodiscard]] double middle() const noexcept { return middle_; }
  /// ln|G| at ln omega = middle + offset.
  [[nodiscard]] long double log_gain(double offset) const;

 private:
  struct Term {
    std::complex<long double> value;  // at the middle, over e^scale
    double order;
  };
  struct Sum {
    std::complex<long double> value;  // at the middle, over e^scale
    std::vector<Term> terms;
    double scale;
    int power;  // negative below the line
  };

  double middle_;
  std::vector<Sum> sums_;
};

}  // namespace frac::detail
