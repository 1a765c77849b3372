// SPDX-License-Identifier: BSD-3-Clause
#include "gap_motion.hpp"

#include <algorithm>
#include <cmath>

#include "arcs.hpp"
#include "base/wide_vectors.hpp"
#include "ordinary_flight.hpp"
#include "reduced_sincos.hpp"

namespace backlash::detail {
namespace {

// Root of distance(h) = target on [lower, upper], where the distance is monotone and brackets the target: Householder's
// iteration of fourth order inside a shrinking bracket.
struct Root {
  double h;
  double velocity;
};
Root monotone_root(const GapState& start, const Flight& flight, double target, double lower, double upper, double guess,
                   bool rising) noexcept {
  const double push = flight.push;
  const double pull = flight.pull;
  const double offset = start.distance - target;
  double h = guess >= lower && guess <= upper ? guess : 0.5 * (lower + upper);
  double velocity = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Arcs a = arcs(h);
    const double residual = offset + start.velocity * h + push * a.one_minus_cos + pull * a.h_minus_sin;
    velocity = start.velocity + push * a.sin + pull * a.one_minus_cos;
    const double acceleration = push * (1 - a.one_minus_cos) + pull * a.sin;
    const double jerk = pull * (1 - a.one_minus_cos) - push * a.sin;
    ((residual < 0) == rising ? lower : upper) = h;
    const double inverse = 1 / velocity;
    const double newton = residual * inverse;
    const double curvature = acceleration * inverse;
    const double twist = jerk * inverse;
    const double bend = newton * curvature;
    // Far from the root, as where the velocity is almost lost on the way, the series behind the iteration means
    // nothing.
    const bool is_near = std::abs(bend) + newton * newton * std::abs(twist) < 1;
    const double step =
        is_near ? -newton * (1 - 0.5 * bend) / (1 - bend + newton * newton * twist * (1.0 / 6)) : -newton;
    // The error that the step leaves is about step (step m)^3, 1/m the length over which the velocity changes by
    // itself.
    const double turned = step * step * (curvature * curvature + std::abs(twist));
    if (is_near && step * step * turned * turned * turned <= 1e-33 * h * h) {
      const double next = std::clamp(h + step, lower, upper);
      const double last = next - h;
      velocity += last * (acceleration + last * (0.5 * jerk - last * acceleration * (1.0 / 6)));
      return {next, velocity};
    }
    double next = h + step;
    if (!(next > lower && next < upper) || iteration % 8 == 7) next = 0.5 * (lower + upper);
    if (next == h) break;
    h = next;
  }
  return {h, velocity};
}

// Ends a flight at a wall: the opposite one, or the one it started from.
FRACFIT_INLINE inline void end_at(const Root& contact, bool crosses, Flight& flight) noexcept {
  flight.hits = true;
  flight.crosses = crosses;
  flight.duration = contact.h;
  flight.speed = std::max(0.0, crosses ? contact.velocity : -contact.velocity);
}

// acos A, from 1 - A.
FRACFIT_INLINE inline double angle_of_rest(double one_minus_a) noexcept {
  if (one_minus_a < 0.5) return 2 * std::asin(std::sqrt(one_minus_a / 2));
  if (one_minus_a > 1.5) return pi - 2 * std::asin(std::sqrt((2 - one_minus_a) / 2));
  return std::acos(1 - one_minus_a);
}

}  // namespace

GapState state_at_peak(double position, double position_rate) noexcept {
  GapState state;
  state.half_period = 1;
  state.s = -half_pi;
  state.sin_s = -1;
  state.cos_s = 0;
  state.wall = position <= 0.5 ? 0 : 1;
  state.distance = state.wall == 0 ? position : 1 - position;
  state.velocity = state.wall == 0 ? position_rate : -position_rate;
  return state;
}

void advance_phase(GapState& state, double h) noexcept {
  const double s = state.s + h;
  const double place = (s + half_pi) * (1 / pi);
  auto whole = static_cast<std::int64_t>(place);
  if (place < static_cast<double>(whole)) --whole;
  const auto turns = static_cast<double>(whole);
  state.s = (s - turns * pi) - turns * pi_low;
  state.half_period += whole;
  const SinCos at = reduced_sincos(state.s);
  state.sin_s = at.sin;
  state.cos_s = at.cos;
}

double radians_to_half_period(const GapState& state, std::int64_t half_period) noexcept {
  return static_cast<double>(half_period - state.half_period) * pi - half_pi - state.s;
}

GapState GapMotion::release_after(const GapState& rest) const noexcept {
  GapState state = rest;
  if (rest.parity() < 0) ++state.half_period;
  state.s = 0;
  state.sin_s = 0;
  state.cos_s = 1;
  state.distance = 0;
  state.velocity = 0;
  return state;
}

DistanceAndVelocity GapMotion::along(const GapState& start, const Flight& flight, double h) const noexcept {
  const Arcs a = arcs(h);
  return {start.distance + start.velocity * h + flight.push * a.one_minus_cos + flight.pull * a.h_minus_sin,
          start.velocity + flight.push * a.sin + flight.pull * a.one_minus_cos};
}

FRACFIT_INLINE inline Flight GapMotion::flight_from(GapState& start) const noexcept {
  const bool starts_backwards =
      start.velocity < 0 || (start.velocity == 0 && start.distance > 0 && start.is_pushed_to_wall());
  if (starts_backwards) {
    start.wall = 1 - start.wall;
    start.distance = 1 - start.distance;
    start.velocity = start.velocity == 0 ? 0 : -start.velocity;
  }
  const double parity = start.parity();
  Flight flight;
  flight.push = parity * gamma_ * start.sin_s;
  flight.pull = parity * gamma_ * start.cos_s;

  if (start.distance == 0 && flight.push < 0 && short_hop(start, start.s < 0 ? -start.s : pi - start.s, flight)) {
    return flight;
  }
  if (ordinary_flight(start, gamma_, inverse_gamma_, flight)) return flight;

  // velocity(h) = parity gamma (A - cos(s + h)) with A = cos s + parity velocity/gamma vanishes at s + h = +-theta + 2
  // pi n, theta = acos A; 1 - A without cancellation at small s.
  const double one_minus_a = start.sin_s * start.sin_s / (1 + start.cos_s) - parity * start.velocity * inverse_gamma_;
  const double drift = parity * gamma_ * (1 - one_minus_a);  // mean velocity
  if (one_minus_a < 0 || one_minus_a > 2) {
    cross_in_one_direction(start, drift, flight);
  } else {
    fly_to_and_fro(start, one_minus_a, drift, flight);
  }
  return flight;
}

// The velocity never vanishes, so the opposite wall is met in the period in which the mean motion brings it there.
FRACFIT_INLINE inline void GapMotion::cross_in_one_direction(const GapState& start, double drift,
                                                             Flight& flight) const noexcept {
  const double limit = 2 * pi * static_cast<double>(max_free_periods);
  const double room = 1 - start.distance;
  const double periods = std::max(0.0, std::floor(room / (2 * pi * drift)) - 1);
  double lower = 2 * pi * periods;
  if (!(lower < limit)) return;
  while (along(start, flight, lower + 2 * pi).distance < 1) {
    lower += 2 * pi;
    if (!(lower < limit)) return;
  }
  const double from = along(start, flight, lower).distance;
  const double to = along(start, flight, lower + 2 * pi).distance;
  const double guess = lower + 2 * pi * std::clamp((1 - from) / (to - from), 0.0, 1.0);
  end_at(monotone_root(start, flight, 1, lower, lower + 2 * pi, guess, true), true, flight);
}

// The distance rises to a top and falls to a bottom in every period; contact is in the first rise or fall that reaches
// a wall.
FRACFIT_INLINE inline void GapMotion::fly_to_and_fro(const GapState& start, double one_minus_a, double drift,
                                                     Flight& flight) const noexcept {
  const double theta = angle_of_rest(one_minus_a);
  // The velocity is positive now; it ends being so at the first top.
  double top = start.parity() > 0 ? (start.s < 0 ? -theta - start.s : 2 * pi - theta - start.s) : theta - start.s;
  double bottom = top + 2 * (start.parity() > 0 ? theta : pi - theta);
  top = std::max(top, 0.0);
  bottom = std::max(bottom, top);
  double rise_from = 0;
  double rise_from_distance = start.distance;
  double rise_velocity = start.velocity;
  std::int64_t passed = 0;
  // Where the velocity vanishes sin(s + h) is known, so the distance there needs no trigonometric function; but that
  // form cancels in short flights and under strong forces.
  const bool cancels = top < 0.5 || gamma_ > 30;
  const double reach = gamma_ * std::sqrt(one_minus_a * (2 - one_minus_a));
  const double middle = start.distance + flight.push;
  const auto top_at = [&](double h) { return cancels ? along(start, flight, h).distance : middle + drift * h + reach; };
  const auto bottom_at = [&](double h) {
    return cancels ? along(start, flight, h).distance : middle + drift * h - reach;
  };
  for (;;) {
    const double top_distance = top_at(top);
    if (top_distance >= 1) {
      const double rise = top_distance - rise_from_distance;
      const double guess =
          rise_from + (top - rise_from) * fraction_before_rest((1 - rise_from_distance) / rise,
                                                               rise_velocity * (top - rise_from) / rise);
      return end_at(monotone_root(start, flight, 1, rise_from, top, guess, true), true, flight);
    }
    const double bottom_distance = bottom_at(bottom);
    if (bottom_distance < 0) {
      const double guess =
          top + (bottom - top) * fraction_between_rests(top_distance / (top_distance - bottom_distance));
      return end_at(monotone_root(start, flight, 0, top, bottom, guess, false), false, flight);
    }
    if (drift == 0) return;
    // No contact in this period: later ones are shifted by the drift, so those out of reach are skipped.
    const double room = drift > 0 ? 1 - top_distance : bottom_distance;
    const double wait = std::floor(room / (2 * pi * std::abs(drift)));
    const double skip = std::max(1.0, wait - 1);
    if (!(static_cast<double>(passed) + skip <= static_cast<double>(max_free_periods))) return;
    passed += static_cast<std::int64_t>(skip);
    top += 2 * pi * skip;
    bottom += 2 * pi * skip;
    rise_from = bottom - 2 * pi;
    rise_velocity = 0;
    rise_from_distance = bottom_at(rise_from);
  }
}

// One code for processors with and without fused multiply-add.
Flight GapMotion::next_flight(GapState& state) const noexcept {
  return frac::detail::with_fused_operations([&]() FRACFIT_INLINE { return flight_from(state); });
}

GapState GapMotion::peak_state(int wall, const DistanceAndVelocity& at) const noexcept {
  const double distance = std::clamp(at.distance, 0.0, 1.0);
  GapState peak = wall == 0 ? state_at_peak(distance, at.velocity) : state_at_peak(1 - distance, -at.velocity);
  if (peak.distance == 0 && peak.velocity < 0) peak.velocity *= -restitution_;
  return peak;
}

GapState GapMotion::after_impact(const GapState& start, const Flight& flight) const noexcept {
  GapState state = start;
  if (flight.has_end) {
    state.half_period = flight.end_half_period;
    state.s = flight.end_s;
    state.sin_s = flight.end_sin;
    state.cos_s = flight.end_cos;
  } else {
    advance_phase(state, flight.duration);
  }
  if (flight.crosses) state.wall = 1 - state.wall;
  state.distance = 0;
  state.velocity = restitution_ * flight.speed;
  return state;
}

ChatterTail GapMotion::chatter_tail(const GapState& state) const noexcept {
  ChatterTail tail;
  const double pressure = -state.parity() * gamma_ * state.sin_s;
  if (!(pressure > 0) || restitution_ >= 1 || state.distance > 0) return tail;
  const double to_reversal = state.s < 0 ? -state.s : pi - state.s;
  // The pressure falls at most linearly to 0 at the reversal, so within a hundredth of the way there it is constant to
  // 1 %, and the geometric series of hops ends.
  const double slowing = pressure * (1 - restitution_);
  if (!(2 * state.velocity <= 0.01 * to_reversal * slowing)) return tail;
  tail.completes = true;
  tail.duration = 2 * state.velocity / slowing;
  const double e3 = restitution_ * restitution_ * restitution_;
  tail.area = 2.0 / 3.0 * state.velocity * state.velocity * state.velocity / (pressure * pressure * (1 - e3));
  // Relative change of the pressure, cot s per radian, and turn of e^{-j k tau}, k <= 5, over the tail.
  tail.area_error = tail.area * tail.duration * (5 + 4 * std::abs(state.cos_s / state.sin_s));
  // Work of the force over the tail: int a dd = -int a' d, the rate of the acceleration a being parity gamma cos s.
  tail.loss = 0.5 * state.velocity * state.velocity - state.parity() * gamma_ * state.cos_s * tail.area;
  return tail;
}

}  // namespace backlash::detail
