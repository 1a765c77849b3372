// SPDX-License-Identifier: BSD-3-Clause
#include "closed_orbit.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

// Above this dimensionless force the velocity jumps are so much larger than their sum that flights are integrated
// instead.
constexpr double strong_force = 30;

// Newton's steps square the residual at a regular orbit.  Where two or three orbits meet they take the distance to 1/2
// or 2/3: from 0.3 to the 1e-5 at which a residual of third order is lost in rounding they are 26.
constexpr int most_newton_steps = 50;
// Steps that do not halve the residual.  A state on the curved line of slow motion has a residual far below the square
// of its distance from the orbit, so the first step raises it.
constexpr int most_misses = 4;

struct Return {
  GapState end;
  Jacobian jacobian;
};

// The n-impact map and its derivative; empty where the mass rests or meets no wall on the way.
std::optional<Return> impact_map(const GapMotion& motion, GapState state, int impacts) {
  Jacobian jacobian;
  for (int i = 0; i < impacts; ++i) {
    if (motion.rests(state)) return std::nullopt;
    const Flight flight = motion.next_flight(state);
    if (!flight.hits) return std::nullopt;
    const GapState next = motion.after_impact(state, flight);
    jacobian = chain(jacobian, motion, state, flight, next);
    state = next;
  }
  return Return{state, jacobian};
}

}  // namespace

Jacobian chain(const Jacobian& before, const GapMotion& motion, const GapState& start, const Flight& flight,
               const GapState& end) noexcept {
  const Displacement phase = pushed({before.phase_phase, before.velocity_phase}, motion, start, flight, end);
  const Displacement velocity = pushed({before.phase_velocity, before.velocity_velocity}, motion, start, flight, end);
  return {phase.phase, velocity.phase, phase.velocity, velocity.velocity};
}

double spectral_radius(double trace, double determinant) noexcept {
  const double discriminant = 0.25 * trace * trace - determinant;
  if (discriminant < 0) return std::sqrt(determinant);
  return 0.5 * std::abs(trace) + std::sqrt(discriminant);
}

std::optional<ClosedOrbit> close_orbit(const GapMotion& motion, const GapState& guess, int impacts,
                                       std::int64_t half_periods, double tolerance) {
  GapState state = guess;
  std::optional<ClosedOrbit> best;
  int misses = 0;
  for (int iteration = 0; iteration < most_newton_steps; ++iteration) {
    const std::optional<Return> after = impact_map(motion, state, impacts);
    if (!after || after->end.wall != guess.wall) break;
    const double phase_error =
        static_cast<double>(after->end.half_period - state.half_period - half_periods) * pi + (after->end.s - state.s);
    const double velocity_error = after->end.velocity - state.velocity;
    const double residual = std::abs(phase_error) + std::abs(velocity_error) / (1 + state.velocity);
    if (!std::isfinite(residual) || !(residual < 1)) break;
    const Jacobian& j = after->jacobian;
    const double a = j.phase_phase - 1;
    const double d = j.velocity_velocity - 1;
    const double determinant = a * d - j.phase_velocity * j.velocity_phase;
    const double phase_step = -(d * phase_error - j.phase_velocity * velocity_error) / determinant;
    const double velocity_step = -(a * velocity_error - j.velocity_phase * phase_error) / determinant;
    const double step = std::abs(phase_step) + std::abs(velocity_step) / (1 + state.velocity);
    const bool improves = !best || residual <= 0.5 * best->residual;
    if (!best || residual < best->residual) best = {state, impacts, half_periods, j, residual, step};
    if (residual <= rounding * impacts || (!improves && (best->residual <= tolerance || ++misses == most_misses)))
      break;
    if (!(std::abs(phase_step) < 0.3) || !std::isfinite(velocity_step)) break;
    const double velocity = state.velocity + velocity_step;
    if (velocity < 0 || velocity > 2 * state.velocity + 1) break;
    advance_phase(state, phase_step);
    state.velocity = velocity;
  }
  if (!best || !(best->residual <= tolerance)) return std::nullopt;
  return best;
}

Harmonics orbit_harmonics(const GapMotion& motion, const ClosedOrbit& orbit) {
  const bool by_flights = motion.gamma() > strong_force;
  JumpSum jumps;
  FlightSum flights;
  GapState state = orbit.start;
  for (int i = 0; i < orbit.impacts; ++i) {
    const Flight flight = motion.next_flight(state);
    const GapState next = motion.after_impact(state, flight);
    if (by_flights) {
      flights.add_flight(state, flight);
      if (flight.crosses) flights.add_crossing(next);
    } else {
      jumps.add(next, flight.speed);
    }
    state = next;
  }
  const auto half_periods = static_cast<double>(orbit.half_periods);
  return by_flights ? flights.harmonics(motion.gamma(), half_periods)
                    : harmonics_of_jumps(jumps, motion.gamma(), half_periods);
}

GapState state_at_next_peak(const GapMotion& motion, const GapState& start, double tail_limit) {
  GapState state = start;
  const std::int64_t peak = (start.half_period & 1) != 0 ? start.half_period + 2 : start.half_period + 1;
  for (;;) {
    if (motion.rests(state) || motion.chatter_tail(state).negligible(tail_limit)) {
      const GapState release = motion.release_after(state);
      if (release.half_period >= peak) return state_at_peak(state.wall, 0);
      state = release;
      continue;
    }
    const Flight flight = motion.next_flight(state);
    const double to_peak = radians_to_half_period(state, peak);
    if (!flight.hits || flight.duration >= to_peak) {
      return motion.peak_state(state.wall, motion.along(state, flight, to_peak));
    }
    state = motion.after_impact(state, flight);
  }
}

}  // namespace backlash::detail
