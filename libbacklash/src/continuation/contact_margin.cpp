// SPDX-License-Identifier: BSD-3-Clause
#include "contact_margin.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

ContactMargin contact_margin(const OrbitSegment& orbit) {
  ContactMargin least{std::numeric_limits<double>::infinity(), true, 0, {}};
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    const SegmentImpact from = orbit.impact(i);
    const SegmentImpact to = orbit.impact(i + 1);
    if (from.speed < least.margin) least = {from.speed, true, i, {}};
    const double start = side_of(from.wall) * orbit.restitution * from.speed;
    const double sin0 = std::sin(from.phase);
    const double cos0 = std::cos(from.phase);
    // The velocity start + gamma (sin tau - sin tau_0) vanishes where sin tau has this value.
    const double sine = sin0 - start / gamma;
    if (std::abs(sine) > 1) continue;
    const double first = std::asin(sine);
    for (const bool rising : {true, false}) {
      // Acceleration gamma cos tau > 0: a lowest point, which meets the wall u = 0; else a highest one.
      const double root = rising ? first : pi - first;
      const double turns = std::ceil((from.phase - root) / (2 * pi));
      for (double tau = root + 2 * pi * turns; tau < to.phase; tau += 2 * pi) {
        const double h = tau - from.phase;
        // At restitution 0 the flight begins with velocity 0, which is no turning point.
        if (h <= 1e-7) continue;
        const double half_sin = std::sin(0.5 * h);
        const double u = from.wall + start * h + gamma * (cos0 * 2 * half_sin * half_sin - sin0 * (h - std::sin(h)));
        const double margin = rising ? u : 1 - u;
        if (margin < least.margin) least = {margin, false, i, {tau, 0, rising ? 0 : 1}};
      }
    }
  }
  return least;
}

}  // namespace backlash::detail
