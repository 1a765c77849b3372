// SPDX-License-Identifier: BSD-3-Clause
#include "flight_equations.hpp"

#include <cmath>

namespace backlash::detail {

FlightEquations flight_equations(double gamma, double restitution, const SegmentImpact& from, const SegmentImpact& to) {
  const double h = to.phase - from.phase;
  const double sin0 = std::sin(from.phase);
  const double cos0 = std::cos(from.phase);
  const double side0 = side_of(from.wall);
  const double side1 = side_of(to.wall);
  const double start = side0 * restitution * from.speed;
  const double half_sin = std::sin(0.5 * h);
  const double one_minus_cos = 2 * half_sin * half_sin;
  const double sin_h = std::sin(h);
  const double pushed = gamma * (cos0 * one_minus_cos - sin0 * (h - sin_h));
  const double gained = gamma * (cos0 * sin_h - sin0 * one_minus_cos);
  FlightEquations e{};
  e.place = (from.wall - to.wall) + start * h + pushed;
  e.velocity = start + gained + side1 * to.speed;
  e.place_phase0 = -start - gamma * cos0 * h;
  e.place_speed0 = side0 * restitution * h;
  e.place_phase1 = start + gained;
  e.velocity_phase0 = -gamma * cos0;
  e.velocity_speed0 = side0 * restitution;
  e.velocity_phase1 = gamma * std::cos(to.phase);
  e.velocity_speed1 = side1;
  e.place_log_gamma = pushed;
  e.velocity_log_gamma = gained;
  e.place_restitution = side0 * from.speed * h;
  e.velocity_restitution = side0 * from.speed;
  return e;
}

}  // namespace backlash::detail
