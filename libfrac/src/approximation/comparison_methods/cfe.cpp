// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>

#include "approximation/unit_design.hpp"

namespace frac::detail {
namespace {

struct PolynomialValue {
  long double value;
  long double slope;
};

// Jacobi polynomial P_degree^(a,-a) at x (Abramowitz and Stegun 22.7.1).
PolynomialValue jacobi(int degree, long double a, long double x) {
  PolynomialValue before{1, 0};
  PolynomialValue here{x + a, 1};
  for (int n = 1; n < degree; ++n) {
    const long double first = (2 * n + 1) / static_cast<long double>(n + 1);
    const long double second = (static_cast<long double>(n) * n - a * a) / (static_cast<long double>(n) * (n + 1));
    const PolynomialValue next{first * x * here.value - second * before.value,
                               first * (here.value + x * here.slope) - second * before.slope};
    before = here;
    here = next;
  }
  return here;
}

}  // namespace

// With x = (s + 1)/(s - 1), s^a = ((x + 1)/(x - 1))^a has at s = 1, x = infinity, the Pade approximant
// P_N^(a,-a)(x)/P_N^(-a,a)(x), which is the even part of its continued fraction.  A root x = cos(angle) is
// s = -cot^2(angle/2), and the mirrored root -x is its reciprocal.
UnitDesign cfe_design(const UnitProblem& problem, int poles) {
  UnitDesign design;
  const long double a = problem.order;
  for (int k = 1; k <= poles; ++k) {
    // Asymptotic root (Abramowitz and Stegun 22.16.1); Newton's iteration from there doubles the digits each time.
    long double angle = (k + a / 2 - 0.25L) * std::numbers::pi_v<long double> / (poles + 0.5L);
    for (int i = 0; i < 6; ++i) {
      const PolynomialValue at = jacobi(poles, a, std::cos(angle));
      angle += at.value / (at.slope * std::sin(angle));
    }
    const long double cotangent = 1 / std::tan(angle / 2);
    design.zeros.push_back(cotangent * cotangent);
    design.poles.push_back(1 / design.zeros.back());
  }
  std::sort(design.zeros.begin(), design.zeros.end());
  std::sort(design.poles.begin(), design.poles.end());
  design.gain = mid_band_gain(design);
  return design;
}

}  // namespace frac::detail
