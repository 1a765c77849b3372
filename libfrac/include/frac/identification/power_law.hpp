// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace frac {

/// y = coefficient x^exponent fitted by least squares of ln y on ln x (maximum likelihood under relative noise).
/// Intervals are 95 %, Student t with n - 2 degrees of freedom; NaN when n = 2.
struct PowerLaw {
  double coefficient;
  double exponent;
  double coefficient_ci95_lower, coefficient_ci95_upper;
  double exponent_standard_error;
  double exponent_ci95_lower, exponent_ci95_upper;
  double r_squared;         // of ln y; NaN when all y are equal
  double rms_log_residual;  // sqrt(sum of squares/(n - 2)); NaN when n = 2

  [[nodiscard]] double operator()(double x) const;
};

/// @throws std::invalid_argument  fewer than 2 points, lengths differ, an entry not positive and finite (the text
///                                names its index),
///                                or all x equal.
[[nodiscard]] PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

}  // namespace frac
