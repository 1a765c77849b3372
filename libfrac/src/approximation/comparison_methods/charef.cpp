// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "approximation/unit_design.hpp"

namespace frac::detail {

// Charef, Sun, Tsao, Onaral (1992) for the corner function (1 + s/corner)^a: asymptotes leave the line of slope
// 20 a dB per decade by at most y dB, which puts zero and pole ratios at 10^(y/(10 a)) and 10^(y/(10 (1-a))); the
// corner lies below the band by sqrt(10^(y/(10 a)) - 1), where (1 + s/corner)^a is y dB from (s/corner)^a, and the
// ladder ends as far above it.  With Y = y ln 10/20 the number of rungs between the two fixes Y:
//   poles 2 Y/(a (1 - a)) = 2 half_width - ln(exp(2 Y/a) - 1).
UnitDesign charef_design(const UnitProblem& problem, int poles) {
  const double a = problem.order;
  const auto surplus = [&](double ripple) {
    return poles * 2 * ripple / (a * (1 - a)) + std::log(std::expm1(2 * ripple / a)) - 2 * problem.half_width;
  };
  // At this ripple the first term alone is the whole band and the logarithm not negative.
  const double most = std::max(problem.half_width * a * (1 - a) / poles, a * std::numbers::ln2 / 2);
  std::uintmax_t iterations = 200;
  const double ripple = boost::math::tools::toms748_solve(surplus, most * 1e-25, most * (1 + 1e-9),
                                                          boost::math::tools::eps_tolerance<double>(50), iterations)
                            .first;
  const double margin = -std::log(std::expm1(2 * ripple / a)) / 2;
  UnitDesign design;
  const long double corner = -static_cast<long double>(problem.half_width) - margin;
  const long double rung = -2 * corner / poles;
  for (int i = 0; i < poles; ++i) {
    design.zeros.push_back(std::exp(corner + (i + (1 - static_cast<long double>(a)) / 2) * rung));
    design.poles.push_back(std::exp(corner + (i + (1 + static_cast<long double>(a)) / 2) * rung));
  }
  design.gain = mid_band_gain(design);
  design.parameters = {{"asymptote_ripple_decibels", ripple * 20 / std::numbers::ln10},
                       {"corner_decades_below_band", margin / std::numbers::ln10}};
  return design;
}

}  // namespace frac::detail
