// SPDX-License-Identifier: BSD-3-Clause
#include "motion/gap_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "support/random.hpp"

namespace {

using backlash::detail::advance_phase;
using backlash::detail::Flight;
using backlash::detail::GapMotion;
using backlash::detail::GapState;

constexpr double pi = std::numbers::pi;

// The motion in plain form, in long double: u and u' after h radians from a state at phase tau.
struct PlainMotion {
  long double gamma, tau, u, rate;
  [[nodiscard]] long double position(long double h) const {
    return u + (rate - gamma * std::sin(tau)) * h - gamma * (std::cos(tau + h) - std::cos(tau));
  }
  [[nodiscard]] long double velocity(long double h) const { return rate + gamma * (std::sin(tau + h) - std::sin(tau)); }
};

PlainMotion plain(const GapState& state, double gamma) {
  const long double tau = static_cast<long double>(state.half_period) * std::numbers::pi_v<long double> -
                          std::numbers::pi_v<long double> / 2 + state.s;
  return {gamma, tau, state.position(), state.position_rate()};
}

// First contact by small steps and bisection.  Empty where a wall is only just missed or touched, so that steps may
// miss it.
struct Contact {
  long double h;
  int wall;
};
std::optional<Contact> contact_by_steps(const PlainMotion& motion, bool& doubtful) {
  doubtful = false;
  long double h = 1e-9L;
  const auto outside = [&](long double x) { return motion.position(x) < 0 || motion.position(x) > 1; };
  while (h < 400) {
    const long double next = h + std::min(1e-3L, 1e-3L * h + 1e-9L);
    if (outside(next)) {
      const int wall = motion.position(next) > 1 ? 1 : 0;
      long double low = h;
      long double high = next;
      for (int i = 0; i < 70; ++i) {
        const long double middle = 0.5L * (low + high);
        (outside(middle) ? high : low) = middle;
      }
      return Contact{high, wall};
    }
    const long double margin = std::min(motion.position(next), 1 - motion.position(next));
    const bool turns = motion.velocity(h) * motion.velocity(next) <= 0;
    if (turns && margin < 1e-5L && next > 1e-4L) doubtful = true;
    h = next;
  }
  return std::nullopt;
}

TEST(GapMotion, NextContactIsTheFirstOneSmallStepsFind) {
  support::Random random(11);
  int compared = 0;
  for (int i = 0; i < 300; ++i) {
    const double gamma = random.log_uniform(0.05, 20);
    GapState state = backlash::detail::state_at_peak(i % 3 == 0 ? 0 : random.unit(), 0);
    advance_phase(state, random.uniform(0, 2 * pi));
    const double speed = random.log_uniform(1e-2, 2);
    state.velocity = state.distance == 0 || random.below(2) == 0 ? speed : -speed;
    const GapMotion motion(gamma, 0.5);
    const PlainMotion reference = plain(state, gamma);
    bool doubtful = false;
    const std::optional<Contact> expected = contact_by_steps(reference, doubtful);
    if (doubtful) continue;
    const Flight flight = motion.next_flight(state);
    if (!expected) {
      EXPECT_TRUE(!flight.hits || flight.duration > 399) << i;
      continue;
    }
    ++compared;
    ASSERT_TRUE(flight.hits) << i;
    EXPECT_EQ(flight.crosses ? 1 - state.wall : state.wall, expected->wall) << i;
    // The place is good to a few roundings of gamma h; the time to that over the speed of contact.
    const double rounding = 1e-15 * (1 + gamma) * (1 + flight.duration);
    EXPECT_NEAR(flight.duration, static_cast<double>(expected->h), rounding / std::max(1e-6, flight.speed)) << i;
    EXPECT_NEAR(flight.speed, std::abs(static_cast<double>(reference.velocity(expected->h))),
                rounding * (1 + gamma / std::max(1e-6, flight.speed)))
        << i;
  }
  EXPECT_GT(compared, 200);
}

TEST(GapMotion, HopsUnderAStrongForceKeepRelativePrecision) {
  // A hop of speed w against the pressure p = gamma |sin s| lasts 2w/p (1 + (w/p) cot s (2/3) + ...): compare with the
  // root of the series of the distance up to h^5 in long double, which leaves (h)^4 = 1e-20.
  for (const double gamma : {1.0, 1e3, 1e9}) {
    for (const double s : {-1.4, -0.3, 0.2, 1.5}) {
      GapState state;
      state.half_period = s < 0 ? 0 : 1;
      advance_phase(state, s);
      const double pressure = -state.parity() * gamma * state.sin_s;
      ASSERT_GT(pressure, 0);
      state.velocity = 1e-5 * pressure;
      const GapMotion motion(gamma, 0.7);
      const Flight flight = motion.next_flight(state);
      ASSERT_TRUE(flight.hits);
      EXPECT_FALSE(flight.crosses);
      // distance/h = w - p h/2 - q h^2/6 + p h^3/24, p and q in units of gamma
      const long double p = std::abs(std::sin(static_cast<long double>(s)));
      const long double q = (s < 0 ? -1 : 1) * std::cos(static_cast<long double>(s));
      const long double w = static_cast<long double>(state.velocity) / gamma;
      long double h = 2 * w / p;
      for (int i = 0; i < 20; ++i) h = 2 * (w - q * h * h / 6 + p * h * h * h / 24) / p;
      EXPECT_NEAR(flight.duration / static_cast<double>(h), 1, 3e-15);
      const long double v = w - p * h - q * h * h / 2 + p * h * h * h / 6;
      EXPECT_NEAR(flight.speed / static_cast<double>(-v * gamma), 1, 5e-15);
    }
  }
}

TEST(GapMotion, ChatterTailEqualsTheSumOfItsHops) {
  for (const double restitution : {0.05, 0.5, 0.9, 0.99}) {
    const GapMotion motion(40, restitution);
    GapState state;
    advance_phase(state, -0.8);
    state.velocity = 1e-3 * (1 - restitution);
    const backlash::detail::ChatterTail tail = motion.chatter_tail(state);
    ASSERT_TRUE(tail.completes);
    double area = 0;
    double duration = 0;
    while (state.velocity > 1e-14) {
      const Flight flight = motion.next_flight(state);
      ASSERT_TRUE(flight.hits && !flight.crosses);
      // Simpson's rule is exact for the cubic part of the distance; the rest is of relative order h^2.
      area += flight.duration * 2 / 3 * motion.along(state, flight, flight.duration / 2).distance;
      duration += flight.duration;
      state = motion.after_impact(state, flight);
    }
    // The pressure changes by a share of about the length of the tail.
    EXPECT_NEAR(tail.duration / duration, 1, 2 * duration);
    EXPECT_LE(std::abs(tail.area - area), tail.area_error);
    EXPECT_GT(area, 0);
  }
}

TEST(GapMotion, RestsWhileTheForcePressesAndLeavesWhenItReverses) {
  const GapMotion motion(3, 0.4);
  GapState state;  // u = 0, force about to turn away from the wall
  EXPECT_FALSE(motion.rests(state));
  advance_phase(state, -0.5);
  EXPECT_TRUE(motion.rests(state));
  const GapState release = motion.release_after(state);
  EXPECT_EQ(release.half_period, 0);
  EXPECT_EQ(release.s, 0);
  state.wall = 1;  // the same force presses away from the other wall
  EXPECT_FALSE(motion.rests(state));
  state.half_period = 2;
  state.s = 0.25;
  state.sin_s = std::sin(0.25);
  EXPECT_TRUE(motion.rests(state));
  EXPECT_EQ(motion.release_after(state).half_period, 3);
  state.velocity = 1e-300;
  EXPECT_FALSE(motion.rests(state));
}

TEST(GapMotion, PhaseDoesNotDriftOverManyPeriods) {
  GapState state;
  const int steps = 1'000'000;
  for (int i = 0; i < steps; ++i) advance_phase(state, 1);
  const long double exact = std::numbers::pi_v<long double>;
  const long double total = static_cast<long double>(state.half_period) * exact + state.s;
  // Each step rounds to half a unit in the last place of a number below pi, in random directions.
  EXPECT_NEAR(static_cast<double>(total - steps), 0, 10 * std::sqrt(static_cast<double>(steps)) * 2.2e-16);
}

TEST(GapMotion, SlowDriftIsFollowedOverManyPeriodsAtOnce) {
  // Nearly force-free: u = drift tau - gamma cos tau + ..., contact when drift h = 1 - O(gamma).
  const double gamma = 1e-7;
  const double drift = 1e-5;
  GapState state = backlash::detail::state_at_peak(0, 0);
  state.velocity = drift;
  const GapMotion motion(gamma, 0.5);
  const Flight flight = motion.next_flight(state);
  ASSERT_TRUE(flight.hits && flight.crosses);
  const PlainMotion reference{gamma, 0, 0, drift};
  EXPECT_NEAR(static_cast<double>(reference.position(flight.duration)), 1, 1e-13);
  EXPECT_NEAR(flight.duration, 1 / drift, 2 * gamma / drift);
  // A drift too slow to arrive within the periods that are followed counts as none.
  state = backlash::detail::state_at_peak(0.5, 0);
  state.velocity = 1e-9;
  EXPECT_FALSE(motion.next_flight(state).hits);
}

TEST(GapMotion, TouchingWithoutSpeedIsNoImpact) {
  // From contact at rest u = gamma (1 - cos tau) comes back to the wall with speed 0, and reaches 2 gamma.
  GapState state = backlash::detail::state_at_peak(0, 0);
  EXPECT_FALSE(GapMotion(0.49, 0.5).next_flight(state).hits);
  state = backlash::detail::state_at_peak(0, 0);
  const Flight flight = GapMotion(0.51, 0.5).next_flight(state);
  ASSERT_TRUE(flight.hits && flight.crosses);
  EXPECT_NEAR(flight.duration, std::acos(1 - 1 / 0.51), 1e-14);
}

// Every flight of long irregular motions ends at a wall, at the speed reported.
TEST(GapMotion, FlightsEndAtTheirWall) {
  const double gammas[] = {0.55, 0.9, 1.4, 2.2, 4.6889036618842406, 9, 25};
  for (const double restitution : {0.4, 0.61029110591143432, 0.8, 0.95, 1.0}) {
    for (const double gamma : gammas) {
      const GapMotion motion(gamma, restitution);
      GapState state = backlash::detail::state_at_peak(0.37, 0.11);
      for (int i = 0; i < 20'000; ++i) {
        if (motion.rests(state) || motion.chatter_tail(state).negligible(1e-13)) {
          // Sticking repeats itself: on with another speed.
          state = motion.release_after(state);
          state.velocity = 1e-3 * (1 + i % 997);
        }
        const Flight flight = motion.next_flight(state);
        ASSERT_TRUE(flight.hits);
        const backlash::detail::DistanceAndVelocity end = motion.along(state, flight, flight.duration);
        // Terms of the distance are below (1 + gamma)(1 + duration); the speed follows the time by the acceleration.
        const double rounding = 1e-15 * (1 + gamma) * (1 + flight.duration);
        ASSERT_NEAR(end.distance, flight.crosses ? 1 : 0, 4 * rounding) << gamma << " " << restitution << " " << i;
        ASSERT_NEAR(std::abs(end.velocity), flight.speed, 1e-10) << gamma << " " << restitution << " " << i;
        state = motion.after_impact(state, flight);
      }
    }
  }
}

TEST(GapMotion, SpeedAlmostLostOnTheWayLeadsToTheOppositeWall) {
  // After the impact the force brakes down to a speed of 0.03, nowhere to 0, and then drives across.
  GapState state;
  advance_phase(state, -0.2122509357574572);
  state.velocity = 0.13804297811194313;
  const GapMotion motion(4.6889036618842406, 0.61);
  const PlainMotion reference = plain(state, 4.6889036618842406);
  bool doubtful = false;
  const std::optional<Contact> expected = contact_by_steps(reference, doubtful);
  ASSERT_TRUE(expected && expected->wall == 1);
  const Flight flight = motion.next_flight(state);
  ASSERT_TRUE(flight.hits && flight.crosses);
  EXPECT_NEAR(flight.duration, static_cast<double>(expected->h), 1e-14);
}

}  // namespace
