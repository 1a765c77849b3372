// SPDX-License-Identifier: BSD-3-Clause
#include "excursion.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace backlash::detail {

namespace {

// Shares of the half period at which a motion is looked at: denser at the ends, where it leaves a wall and meets the
// other one.
constexpr std::size_t points = 64;
std::array<double, points> looked_at() {
  std::array<double, points> shares;
  for (std::size_t i = 1; i < points; ++i)
    shares[i - 1] = 0.5 - 0.5 * std::cos(std::numbers::pi * static_cast<double>(i) / points);
  shares.back() = 1 - 1e-6;
  return shares;
}

}  // namespace

double largest_excursion(const std::function<GapSample(double)>& gap, double half_period) {
  static const std::array<double, points> shares = looked_at();
  double largest = 0;
  // An extremum lies where the rate changes its sign.
  double before_at = 1e-6;
  double before = gap(before_at * half_period).rate;
  for (const double at : shares) {
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
