// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "arcs.hpp"
#include "gap_motion.hpp"
#include "reduced_sincos.hpp"

/// Flights in which walls, turning points and contacts lie clear of each other: nearly all under moderate forces. Their
/// contact is found at a fraction of the cost of the general search, with one evaluation of a sine; whatever is not
/// clear is left to that search.
namespace backlash::detail {

inline constexpr double pi = std::numbers::pi;
inline constexpr double pi_low = 1.2246467991473532e-16;  // pi - double(pi)
inline constexpr double half_pi = pi / 2;

/// Starting value for the fraction of a monotone piece of motion after which it has covered the share y of its length:
/// inverts the cubic that begins and ends with velocity 0, to 1e-2.
[[gnu::always_inline]] inline double fraction_between_rests(double y) noexcept {
  const double share = std::clamp(y, 0.0, 1.0);
  const double near = std::min(share, 1 - share);
  const double root = std::sqrt(near * (1.0 / 3)) * (1 + 0.45 * near);
  return share <= 0.5 ? root : 1 - root;
}

/// The root of the cubic that begins with `slope` (in lengths per piece), by one Newton step from a blend of its cases
/// slope 0 and 2.
[[gnu::always_inline]] inline double fraction_before_rest(double y, double slope) noexcept {
  const double share = std::clamp(y, 0.0, 1.0);
  const double between = fraction_between_rests(share);
  const double blend = std::min(0.5 * slope, 1.0);
  const double t = between + blend * (1 - std::sqrt(1 - share) - between);
  const double value = t * (slope + t * (3 - 2 * slope + t * (slope - 2)));
  const double rate = slope + t * (6 - 4 * slope + t * (3 * slope - 6));
  return rate > 0 ? std::clamp(t - (value - share) / rate, 0.0, 1.0) : t;
}

/// acos(1 - x) for x in [0, 2] to 2e-8 of itself (Abramowitz, Stegun 1964, 4.4.46).
[[gnu::always_inline]] inline double rough_acos_of_one_minus(double x) noexcept {
  const double near = std::min(x, 2 - x);
  const double y = 1 - near;
  const double z = y * y;
  const double w = z * z;
  const double angle =
      std::sqrt(near) * (((1.5707963050 + y * -0.2145988016) + z * (0.0889789874 + y * -0.0501743046)) +
                         w * ((0.0308918810 + y * -0.0170881256) + z * (0.0066700901 + y * -0.0012624911)));
  return x <= 1 ? angle : pi - angle;
}

/// Phase psi with psi - e sin psi = m (Kepler's equation), |e| < 1, |m| < 6000: to third order in e, with sines that
/// are good to 1e-3.  Beyond, and for NaN, some finite phase.
[[gnu::always_inline]] inline double rough_kepler(double mean, double e) noexcept {
  const double m = mean < 6000 ? (mean > -6000 ? mean : -6000.0) : 6000.0;
  const double base = e < 0 ? pi : 0;  // psi - pi solves it with -e
  const double turns = 2 * pi * static_cast<double>(static_cast<int>((m - base) * (0.5 / pi) + 1000.5) - 1000);
  const double reduced = (m - base) - turns;
  const double size = std::abs(reduced);
  const auto rough_sin = [](double x) {
    const double arch = (4 / (pi * pi)) * x * (pi - std::abs(x));
    return arch * (0.775 + 0.225 * std::abs(arch));
  };
  const double steep = std::min(std::abs(e), 1.0);
  const double shift = std::min(steep, steep * rough_sin(size) / (1 - steep * rough_sin(half_pi - size)));
  return (base + turns) + (reduced + std::copysign(shift, reduced));
}

/// The parts of the motion after a start: distance(h) = middle + drift h - strength sin(s + h), velocity(h) = drift
/// - strength cos(s + h).
struct FlightTerms {
  double middle;
  double drift;
  double strength;  // parity gamma
};

/// What the distance and the velocity of a flight are h radians after its start, without cancellation in short ones.
struct FlightPlace {
  double distance, velocity, acceleration, jerk;
};
[[gnu::always_inline]] inline FlightPlace place_after(const GapState& start, const Flight& flight, double h) noexcept {
  const Arcs a = arcs(h);
  return {start.distance + (start.velocity * h + (flight.push * a.one_minus_cos + flight.pull * a.h_minus_sin)),
          start.velocity + (flight.push * a.sin + flight.pull * a.one_minus_cos),
          flight.push * (1 - a.one_minus_cos) + flight.pull * a.sin,
          flight.pull * (1 - a.one_minus_cos) - flight.push * a.sin};
}

/// Step of Householder's iteration of fourth order towards residual = 0, with one division.
struct Step {
  double length;
  bool near;  // the series behind it holds: the velocity keeps its sign over the step
  bool last;  // the error it leaves is below rounding of h
};
[[gnu::always_inline]] inline Step householder_step(double h, double residual, double velocity, double acceleration,
                                                    double jerk) noexcept {
  const double square = velocity * velocity;
  const double cube = velocity * square;
  const double bend = residual * acceleration;
  const double twist = residual * residual * jerk;
  const double length = -residual * (square - 0.5 * bend) / (cube - (bend * velocity - twist * (1.0 / 6)));
  // The error that the step leaves is about length (length m)^3, 1/m the length over which the velocity changes by
  // itself.
  const double square_length = length * length;
  const double change = square_length * (acceleration * acceleration + std::abs(jerk * velocity));
  return {length, std::abs(bend * velocity) + std::abs(twist) < std::abs(cube),
          square_length * change * change * change <= 1e-32 * h * h * (cube * cube)};
}

/// Root of distance(h) = target in (lower, upper), near guess, for flights below 1/2 radian.
[[gnu::always_inline]] inline bool short_root(const GapState& start, double target, double guess, double lower,
                                              double upper, Flight& flight) noexcept {
  double h = guess;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const FlightPlace at = place_after(start, flight, h);
    const Step step = householder_step(h, at.distance - target, at.velocity, at.acceleration, at.jerk);
    if (!step.near) return false;
    h += step.length;
    if (!(h > lower && h < upper)) return false;
    if (step.last) {
      flight.hits = true;
      flight.duration = h;
      flight.speed = std::abs(
          at.velocity +
          step.length * (at.acceleration + step.length * (0.5 * at.jerk - step.length * at.acceleration * (1.0 / 6))));
      return true;
    }
  }
  return false;
}

/// Root of distance(h) = target in (lower, upper), near guess.  The sine of the phase is computed once and then turned
/// with each step of the iteration.  False where that does not converge at once, or where the terms of the distance
/// cancel.
[[gnu::always_inline]] inline bool ordinary_root(const GapState& start, const FlightTerms& terms, double target,
                                                 double guess, double lower, double upper, Flight& flight) noexcept {
  constexpr double shortest = 0.45;
  if (guess < shortest) return short_root(start, target, guess, lower, upper, flight);
  double h = guess;
  const double phase = start.s + h;
  const auto turns = static_cast<int>(phase * (1 / pi) + 0.5);  // the phase is above -pi/2
  const auto turned = static_cast<double>(turns);
  double s = (phase - turned * pi) - turned * pi_low;
  const double strength = (turns & 1) != 0 ? -terms.strength : terms.strength;
  const double offset = terms.middle - target;
  SinCos at = reduced_sincos(s);
  for (int iteration = 0; iteration < 5; ++iteration) {
    const double acceleration = strength * at.sin;
    const double jerk = strength * at.cos;
    const double velocity = terms.drift - jerk;
    const Step step = householder_step(h, (offset + terms.drift * h) - acceleration, velocity, acceleration, jerk);
    if (!step.near) return false;
    h += step.length;
    s += step.length;
    if (step.last) {
      if (!(h >= shortest && h > lower && h < upper)) return false;
      // Steps here are below 1e-3.
      const double square = step.length * step.length;
      const double sine = step.length * (1 - square * (1.0 / 6));
      const double versine = 0.5 * square * (1 - square * (1.0 / 12));
      at = {at.sin + (at.cos * sine - at.sin * versine), at.cos - (at.sin * sine + at.cos * versine)};
      const int back = s >= half_pi ? 1 : s < -half_pi ? -1 : 0;
      flight.hits = true;
      flight.duration = h;
      flight.speed = std::abs(terms.drift - strength * at.cos);
      flight.has_end = true;
      flight.end_half_period = start.half_period + (turns + back);
      flight.end_s = back == 0 ? s : (s - back * pi) - back * pi_low;
      flight.end_sin = back == 0 ? at.sin : -at.sin;
      flight.end_cos = std::abs(at.cos);
      return true;
    }
    if (!(std::abs(step.length) < 0.78)) return false;
    const SinCos turn = sincos_of_small(step.length);
    at = {at.sin * turn.cos + at.cos * turn.sin, at.cos * turn.cos - at.sin * turn.sin};
  }
  return false;
}

/// The next contact, where the flight is an ordinary one.
/// @param start  with velocity >= 0
/// @param flight  push and pull set
[[gnu::always_inline]] inline bool ordinary_flight(const GapState& start, double gamma, double inverse_gamma,
                                                   Flight& flight) noexcept {
  if (!(gamma > 1e-3 && gamma < 1e4)) return false;
  const double parity = start.parity();
  const FlightTerms terms{start.distance + flight.push, start.velocity + flight.pull, parity * gamma};
  // velocity(h) vanishes where cos(s + h) = A.
  const double a = start.cos_s + parity * start.velocity * inverse_gamma;
  // The time at which the opposite wall is met where the velocity hardly turns, from Kepler's equation for the phase.
  const auto crossing_with_the_drift = [&] {
    const double inverse = 1 / terms.drift;
    return rough_kepler((1 - terms.middle) * inverse + start.s, terms.strength * inverse) - start.s;
  };
  if (!(std::abs(a) <= 1)) {
    // It never does turn.
    if (!ordinary_root(start, terms, 1, crossing_with_the_drift(), 0, 6000, flight)) return false;
    flight.crosses = true;
    return true;
  }
  // Times of turning points to 1e-7, so those must lie clear of the walls by more than the margin.
  const double margin = 1e-6 * (1 + gamma);
  const double theta = rough_acos_of_one_minus(1 - a);
  const double rising = 2 * (parity > 0 ? pi - theta : theta);  // time from a bottom to the next top
  // The velocity is positive now and ends being so at the first top.
  const double top = parity < 0 ? theta - start.s : (start.s < 0 ? 0 : 2 * pi) - theta - start.s;
  if (!(top > 1e-3)) return false;
  const double bottom = top + (2 * pi - rising);
  const double reach = gamma * std::sqrt((1 - a) * (1 + a));
  double top_distance = terms.middle + terms.drift * top + reach;
  if (top < 0.5) top_distance = place_after(start, flight, top).distance;
  if (top_distance > 1 + margin) {
    double guess = parity * a > 0.6 ? crossing_with_the_drift() : 0;
    if (!(guess > 0 && guess < top)) {
      const double scale = 1 / (top_distance - start.distance);
      guess = top * fraction_before_rest((1 - start.distance) * scale, start.velocity * top * scale);
    }
    if (!ordinary_root(start, terms, 1, guess, 0, top, flight)) return false;
    flight.crosses = true;
    return true;
  }
  if (!(top_distance < 1 - margin)) return false;
  const double bottom_distance = terms.middle + terms.drift * bottom - reach;
  if (bottom_distance < -margin) {
    const double guess = top + (bottom - top) * fraction_between_rests(top_distance / (top_distance - bottom_distance));
    return ordinary_root(start, terms, 0, guess, top, bottom, flight);
  }
  const double next_distance = top_distance + 2 * pi * terms.drift;
  if (!(bottom_distance > margin && next_distance > 1 + margin)) return false;
  double guess = parity * a > 0.6 ? crossing_with_the_drift() : 0;
  if (!(guess > bottom && guess < bottom + rising)) {
    guess = bottom + rising * fraction_between_rests((1 - bottom_distance) / (next_distance - bottom_distance));
  }
  if (!ordinary_root(start, terms, 1, guess, bottom, bottom + rising, flight)) return false;
  flight.crosses = true;
  return true;
}

/// A hop so short that the force presses towards the wall all through it: distance(h)/h falls to its single root, which
/// lies below 2.5 velocity/|push| because the push of a sine shrinks at most linearly on its way to the reversal.
[[gnu::always_inline]] inline bool short_hop(const GapState& start, double to_reversal, Flight& flight) noexcept {
  const double pressure = -flight.push;
  const double limit = 2.5 * start.velocity;  // times 1/pressure
  if (!(limit < 0.5 * std::min(to_reversal, 1.0) * pressure && start.velocity * limit < pressure)) return false;
  // velocity - pressure h/2 + pull h^2/6 = 0 to fourth order in q.
  const double inverse = 1 / pressure;
  const double q = (2.0 / 3) * start.velocity * flight.pull * inverse * inverse;
  double h = 2 * start.velocity * inverse * (1 + q * (1 + q * (2 + 5 * q)));
  double velocity = 0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Arcs a = arcs(h);
    // h times the mean velocity and its rate of change, and Halley's iteration with the curvature pull/3.
    const double distance = start.velocity * h + (flight.push * a.one_minus_cos + flight.pull * a.h_minus_sin);
    velocity = start.velocity + flight.push * a.sin + flight.pull * a.one_minus_cos;
    const double rate = velocity * h - distance;
    const double step = -distance * rate * h / (rate * rate - distance * h * h * flight.pull * h * (1.0 / 6));
    const double next = std::clamp(h + step, 0.5 * h, 1.25 * limit * inverse);
    const double moved = next - h;
    velocity += moved * (flight.push * (1 - a.one_minus_cos) + flight.pull * a.sin);
    h = next;
    if (std::abs(moved) <= 1e-6 * h) break;
  }
  flight.hits = true;
  flight.crosses = false;
  flight.duration = h;
  flight.speed = std::abs(velocity);
  return true;
}

}  // namespace backlash::detail
