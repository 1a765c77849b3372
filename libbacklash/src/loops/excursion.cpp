// SPDX-License-Identifier: BSD-3-Clause
#include "excursion.hpp"

#include <algorithm>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace backlash::detail {

double largest_excursion(const std::function<GapSample(double)>& gap, double half_period) {
  constexpr int points = 64;
  double largest = 0;
  // Denser at the ends, where the motion leaves a wall and meets the other one; an extremum lies where the rate changes
  // its sign.
  double before_at = 1e-6;
  double before = gap(before_at * half_period).rate;
  for (int i = 1; i <= points; ++i) {
    const double at = i == points ? 1 - 1e-6 : 0.5 - 0.5 * std::cos(std::numbers::pi * i / points);
    const double after = gap(at * half_period).rate;
    if ((before > 0) != (after > 0) && before != 0 && after != 0) {
      std::uintmax_t evaluations = 40;
      const auto [low, high] =
          boost::math::tools::toms748_solve([&](double share) { return gap(share * half_period).rate; }, before_at, at,
                                            before, after, boost::math::tools::eps_tolerance<double>(30), evaluations);
      largest = std::max(largest, std::abs(gap(0.5 * (low + high) * half_period).value));
    }
    before_at = at;
    before = after;
  }
  return largest;
}

}  // namespace backlash::detail
