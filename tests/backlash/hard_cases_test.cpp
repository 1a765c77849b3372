#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "backlash/impact_simulation.hpp"
#include "detail/gap_motion.hpp"
#include "detail/steady_state.hpp"
#include "detail/two_impact_orbit.hpp"
#include "support/random.hpp"

namespace {

using backlash::Impact;
using backlash::ImpactHistory;
using backlash::Regime;
using backlash::TwoMassSystem;
using backlash::detail::advance_phase;
using backlash::detail::find_steady_state;
using backlash::detail::Flight;
using backlash::detail::GapMotion;
using backlash::detail::GapState;
using backlash::detail::state_at_peak;
using backlash::detail::SteadyState;

constexpr double pi = std::numbers::pi;
constexpr double ulp = std::numeric_limits<double>::epsilon();

TEST(HardCases, EitherSideOfEveryThresholdHasAFiniteBalancedAnswer) {
  for (const double restitution : {0.0, 1e-12, 0.2, 0.6, 0.9, 1 - 1e-12, 1.0}) {
    for (const double threshold : {backlash::detail::saddle_node_gamma(restitution),
                                   backlash::detail::symmetry_breaking_gamma(restitution), 0.5, 1 / pi}) {
      if (!(threshold > 1e-6)) continue;  // without dissipation the saddle-node is at gamma = 0
      for (const double side : {-1e-12, 0.0, 1e-12}) {
        const double gamma = threshold * (1 + side);
        const GapMotion motion(gamma, restitution);
        for (const GapState& start : {state_at_peak(0.5, 0), state_at_peak(0, 0), state_at_peak(0.1, 0.8)}) {
          const SteadyState steady = find_steady_state(motion, start, 1e-10);
          SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
          EXPECT_TRUE(std::isfinite(std::abs(steady.harmonics.u[0])));
          EXPECT_TRUE(std::isfinite(steady.uncertainty));
          EXPECT_LE(std::abs(steady.harmonics.u[0]), 2 / pi + steady.uncertainty);
          // Closed to 1e-10, balanced to that.
          EXPECT_LT(steady.energy_defect, 1e-9);
        }
      }
    }
  }
}

TEST(HardCases, ThresholdsDecideOnTheRightSide) {
  for (const double restitution : {0.2, 0.6, 0.9}) {
    const double node = backlash::detail::saddle_node_gamma(restitution);
    EXPECT_FALSE(backlash::detail::symmetric_two_impact_orbit(node * (1 - 1e-12), restitution));
    EXPECT_TRUE(backlash::detail::symmetric_two_impact_orbit(node * (1 + 1e-12), restitution));
    const double breaking = backlash::detail::symmetry_breaking_gamma(restitution);
    EXPECT_TRUE(backlash::detail::stable_two_impact_orbit(breaking * (1 - 1e-12), restitution).value().symmetric());
    // Just above, the asymmetry sqrt(1e-12) is already there.
    EXPECT_FALSE(backlash::detail::stable_two_impact_orbit(breaking * (1 + 1e-12), restitution).value().symmetric());
  }
  // From contact at rest u = gamma (1 - cos tau) reaches the other wall at gamma = 1/2.
  for (const double gamma : {0.5 * (1 - 1e-12), 0.5 * (1 + 1e-12)}) {
    GapState state = state_at_peak(0, 0);
    const Flight flight = GapMotion(gamma, 0.6).next_flight(state);
    EXPECT_EQ(flight.hits && flight.crosses, gamma > 0.5);
    // u'' = -gamma at the top: the speed of contact is sqrt(2 gamma (2 gamma - 1)) = 1e-6, its square a difference of
    // numbers near 1.
    if (gamma > 0.5) {
      EXPECT_NEAR(flight.speed, std::sqrt(2 * gamma * (2 * gamma - 1)), 1e-9);
    }
  }
}

TEST(HardCases, GrazingIsResolvedToFourteenDigits) {
  // A turning point 1e-14 beyond the wall is a contact, one 1e-14 before it is none.
  for (const double beyond : {-1e-14, 1e-14}) {
    GapState state = state_at_peak(0, 0);
    const double gamma = 0.5 * (1 + beyond);
    const Flight flight = GapMotion(gamma, 0.6).next_flight(state);
    EXPECT_EQ(flight.hits, beyond > 0) << beyond;
    if (flight.hits) {
      EXPECT_LT(flight.speed, 2e-7);
    }
  }
}

TEST(HardCases, StartOnAWallAtRestLeavesOrStaysAsTheForceSays) {
  const GapMotion motion(2, 0.5);
  for (const int wall : {0, 1}) {
    for (const int peak : {0, 1}) {
      // Force away from the wall u = 0 at even half turns, towards it at odd ones; the other way round at u = 1.
      GapState state = state_at_peak(wall, 0);
      advance_phase(state, peak * pi);
      const bool pressed = wall != peak;
      EXPECT_EQ(motion.rests(state), pressed);
      if (pressed) {
        const GapState release = motion.release_after(state);
        EXPECT_EQ(release.s, 0);
        EXPECT_FALSE(motion.rests(release));
        state = release;
      }
      const Flight flight = motion.next_flight(state);
      ASSERT_TRUE(flight.hits);
      EXPECT_TRUE(flight.crosses);
    }
  }
}

TEST(HardCases, BothWallsWithinABillionthOfARadian) {
  const double speed = 3e9;
  const GapMotion motion(1, 0.9);
  GapState state = state_at_peak(0, speed);
  const Flight first = motion.next_flight(state);
  ASSERT_TRUE(first.hits && first.crosses);
  EXPECT_NEAR(first.duration * speed, 1, 1e-12);
  const GapState there = motion.after_impact(state, first);
  EXPECT_NEAR(there.velocity / (0.9 * speed), 1, 1e-15);
  GapState back = there;
  const Flight second = motion.next_flight(back);
  ASSERT_TRUE(second.hits && second.crosses);
  EXPECT_NEAR(second.duration * 0.9 * speed, 1, 1e-12);
}

TEST(HardCases, TenMillionPeriodsDoNotDrift) {
  const double restitution = 0.6;
  const auto orbit = backlash::detail::symmetric_two_impact_orbit(0.3, restitution).value();
  const GapMotion motion(0.3, restitution);
  GapState state = orbit.start;
  const std::int64_t periods = 10'000'000;
  for (std::int64_t i = 0; i < 2 * periods; ++i) {
    const Flight flight = motion.next_flight(state);
    state = motion.after_impact(state, flight);
  }
  EXPECT_EQ(state.half_period, orbit.start.half_period + 2 * periods);
  // A stable orbit: rounding of each impact, a few times 1e-16, dies out at once.
  EXPECT_NEAR(state.s, orbit.start.s, 1e-14);
  EXPECT_NEAR(state.velocity, orbit.start.velocity, 1e-14);
}

// Least distance of a flight from its wall and from the other one, at its turning points and evenly between.
void expect_no_penetration(const GapMotion& motion, const GapState& start, const Flight& flight) {
  // Rounding of the terms of the distance.
  const double bound = 4 * ulp * (1 + motion.gamma() * (1 + flight.duration));
  for (int i = 0; i <= 8; ++i) {
    const double distance = motion.along(start, flight, flight.duration * i / 8).distance;
    ASSERT_GE(distance, -bound);
    ASSERT_LE(distance, 1 + bound);
  }
}

TEST(HardCases, RandomScenesKeepEveryInvariant) {
  support::Random random(101);
  std::int64_t impacts = 0;
  for (int scene = 0; scene < 100'000; ++scene) {
    const double gamma = random.log_uniform(0.05, 1e3);
    const double restitution = scene % 50 == 0 ? 1 : random.unit();
    const GapMotion motion(gamma, restitution);
    const double rate = random.uniform(-1, 1);
    GapState state = state_at_peak(random.uniform(0.01, 0.99), rate);
    double kinetic = 0.5 * rate * rate;
    for (int i = 0; i < 12; ++i) {
      if (motion.rests(state) || motion.chatter_tail(state).negligible(1e-14)) {
        kinetic = 0;
        state = motion.release_after(state);
      }
      const GapState begin = state;
      const Flight flight = motion.next_flight(state);
      if (!flight.hits) break;
      ++impacts;
      expect_no_penetration(motion, state, flight);
      const GapState next = motion.after_impact(state, flight);
      ASSERT_EQ(next.velocity, restitution * flight.speed);
      // Work along the flight from the integral of force times velocity, v0 F + F^2/2 with F the impulse.
      const double impulse =
          flight.push * std::sin(flight.duration) + flight.pull * 2 * std::pow(std::sin(flight.duration / 2), 2);
      const double gained = impulse * (state.velocity + 0.5 * impulse);
      const double arriving = 0.5 * flight.speed * flight.speed;
      const double size = kinetic + arriving + std::abs(gained) + gamma * (gamma + 1);
      ASSERT_NEAR(kinetic + gained, arriving, 1e-13 * size * (1 + flight.duration)) << scene << " " << begin.s;
      kinetic = 0.5 * next.velocity * next.velocity;
      state = next;
    }
  }
  EXPECT_GT(impacts, 500'000);
}

TEST(HardCases, RandomScenesKeepMomentumAndRestitutionForAnyMasses) {
  support::Random random(202);
  for (int scene = 0; scene < 5'000; ++scene) {
    const TwoMassSystem system(random.log_uniform(1e-9, 1e9), random.log_uniform(1e-3, 1e3),
                               random.log_uniform(1e-12, 1e6), random.unit());
    const double force = random.log_uniform(1e-3, 1e3);
    const double omega = std::sqrt(force / system.mass2() / system.clearance() / random.log_uniform(0.3, 30));
    const ImpactHistory history =
        backlash::simulate_impacts(system, force, omega, {system.clearance() * random.unit(), 0}, 3);
    const double total = system.mass1() + system.mass2();
    for (const Impact& impact : history.impacts) {
      const double size = std::abs(impact.before.mass1) + std::abs(impact.before.mass2) + std::abs(impact.after.mass1) +
                          std::abs(impact.after.mass2);
      ASSERT_NEAR(system.mass1() / total * (impact.after.mass1 - impact.before.mass1) +
                      system.mass2() / total * (impact.after.mass2 - impact.before.mass2),
                  0, 4 * ulp * size);
      const double relative = impact.before.mass2 - impact.before.mass1;
      ASSERT_NEAR(impact.after.mass2 - impact.after.mass1, -system.restitution() * relative, 8 * ulp * size);
      ASSERT_GE(impact.energy_loss, 0);
    }
  }
}

}  // namespace
