// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "approximation/unit_design.hpp"

namespace frac::detail {

// Xue, Zhao, Chen (2006), eq. 10, written there for a band with its geometric mean at 1 rad/s and so used here: with
// W the upper edge, s (d s + b W)/(d (1 - a) s^2 + b W s + d a) times Oustaloup's ladder.  Since W > 1 and
// b^2 > d^2 >= 4 d^2 a (1 - a), the roots of the quadratic are real.  The factor (d W/b)^a of the paper leaves the gain
// off by (d/b)^a; the gain is set at mid-band instead.
UnitDesign refined_oustaloup_design(const UnitProblem& problem, int poles) {
  constexpr long double b = 10;
  constexpr long double d = 9;
  const long double a = problem.order;
  const long double upper = std::exp(static_cast<long double>(problem.half_width));
  UnitDesign design = oustaloup_design(problem, poles - 2);
  const long double linear = b * upper;
  const long double larger = (linear + std::sqrt(linear * linear - 4 * d * d * a * (1 - a))) / (2 * d * (1 - a));
  design.poles.push_back(larger);
  design.poles.push_back(a / ((1 - a) * larger));
  design.zeros.push_back(0);
  design.zeros.push_back(linear / d);
  std::sort(design.zeros.begin(), design.zeros.end());
  std::sort(design.poles.begin(), design.poles.end());
  design.gain = mid_band_gain(design);
  design.parameters = {{"b", static_cast<double>(b)}, {"d", static_cast<double>(d)}};
  return design;
}

}  // namespace frac::detail
