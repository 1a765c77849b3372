// SPDX-License-Identifier: BSD-3-Clause
#include "visible_jump.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "steady_state.hpp"
#include "two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

constexpr double tolerance = 1e-10;
// Below the jump a sweep upwards passes hundreds of chaotic points, of which it needs the state alone: following each
// until it has outlasted the known transients takes 20 to 60 times as long from restitution 0.9 on and moves no jump by
// more than the width of its bracket.
constexpr MeanGoal passing{0, 0, Transients::ignored};
// Sweep in c = omega / sqrt(F/(M2 clearance)): factor from point to point, and its range.  All jumps lie well inside.
constexpr double factor = 1.002;
constexpr double lowest = 0.9;
constexpr double highest = 1.9;
// The bracket of a jump is narrowed to this relative width.
constexpr double bracket_width = 1e-6;
// A mean over a thousand periods counts impacts to one in a thousand.
constexpr double counting_error = 2e-3;

struct Point {
  double c;
  SteadyState steady;
  [[nodiscard]] bool two_impacts() const { return std::abs(steady.impacts_per_period - 2) <= counting_error; }
  // Proportional to Im N1.
  [[nodiscard]] double imaginary() const { return steady.harmonics.u[0].imag(); }
};

Point next_point(const Point& from, double c, double restitution, const MeanGoal& goal = {}) {
  const GapState start = state_at_peak(from.steady.end.position(), from.steady.end.position_rate() * from.c / c);
  return {c, find_steady_state(GapMotion(1 / (c * c), restitution), start, tolerance, goal)};
}

std::string rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return text(std::round(value * unit) / unit + 0.0);
}

// Narrows a bracket by carrying the state of the point before the jump.
JumpFrequency refine(Point before, Point after, double restitution, bool two_impacts_before) {
  while (std::abs(after.c / before.c - 1) > bracket_width) {
    Point middle = next_point(before, std::sqrt(before.c * after.c), restitution);
    (middle.two_impacts() == two_impacts_before ? before : after) = middle;
  }
  const double step = 100 * (after.imaginary() / before.imaginary() - 1);
  return {std::sqrt(before.c * after.c), rounded(before.steady.impacts_per_period, 3) + " impacts per period become " +
                                             rounded(after.steady.impacts_per_period, 3) + ", Im N1 changes by " +
                                             rounded(step, 1) + " %"};
}

JumpFrequency upwards(double restitution) {
  Point previous{lowest, find_steady_state(GapMotion(1 / (lowest * lowest), restitution), state_at_peak(0.5, 0),
                                           tolerance, passing)};
  std::optional<std::pair<Point, Point>> bracket;
  while (previous.c * factor <= highest) {
    const Point point = next_point(previous, previous.c * factor, restitution, passing);
    if (point.two_impacts() && !previous.two_impacts()) bracket = {previous, point};
    previous = point;
  }
  if (!bracket || !previous.two_impacts()) {
    return {std::nullopt, "sweeping up from c = " + text(lowest) +
                              " no motion of two impacts per period sets in up to c = " + text(highest)};
  }
  return refine(bracket->first, bracket->second, restitution, false);
}

JumpFrequency downwards(double restitution) {
  // Start on the stable orbit, well above its loss.  At small restitution its range of frequencies is less than 10 %
  // wide, so that the start is never beyond the middle of it.
  const double loss = two_impact_loss(restitution).gamma;
  const double start = std::min(1.1 / std::sqrt(loss), 1 / std::pow(loss * saddle_node_gamma(restitution), 0.25));
  const std::optional<TwoImpactOrbit> orbit = stable_two_impact_orbit(1 / (start * start), restitution);
  if (!orbit) return {std::nullopt, "no stable two-impact orbit to start from at c = " + text(start)};
  Point previous{start, two_impact_steady_state(*orbit, restitution)};
  while (previous.c / factor >= lowest) {
    const Point point = next_point(previous, previous.c / factor, restitution);
    if (!point.two_impacts()) return refine(previous, point, restitution, true);
    previous = point;
  }
  return {std::nullopt, "sweeping down the motion keeps two impacts per period to c = " + text(lowest)};
}

}  // namespace

JumpFrequency visible_jump(double restitution, Protocol protocol) {
  if (restitution == 0) {
    return {std::nullopt,
            "at restitution 0 the masses stick after each impact, so two impacts per period remain at every lower "
            "frequency"};
  }
  if (restitution == 1) {
    return {std::nullopt,
            "without dissipation no motion is attracted, so a sweep shows long-time means of chaos and no jump"};
  }
  return protocol == Protocol::sweep_up ? upwards(restitution) : downwards(restitution);
}

}  // namespace backlash::detail
