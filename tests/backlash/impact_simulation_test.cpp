// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/impact_simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "backlash/describing_function.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::Impact;
using backlash::ImpactHistory;
using backlash::simulate_impacts;
using backlash::TwoMassSystem;
using backlash::Wall;
using support::expect_invalid_argument;

constexpr double pi = std::numbers::pi;

TEST(ImpactSimulation, KeepsMomentumRestitutionAndEnergyAtEveryImpact) {
  support::Random random(3);
  std::size_t impacts = 0;
  for (int scene = 0; scene < 50; ++scene) {
    const TwoMassSystem system(random.log_uniform(0.01, 100), random.log_uniform(0.01, 100),
                               random.log_uniform(1e-3, 10), random.unit());
    const double force = random.log_uniform(0.1, 1e3);
    const double omega = std::sqrt(force / system.mass2() / system.clearance() / random.log_uniform(0.3, 100));
    const ImpactHistory history = simulate_impacts(system, force, omega, {system.clearance() / 2, 0}, 20);
    double last = 0;
    for (const Impact& impact : history.impacts) {
      ++impacts;
      const double m1 = system.mass1();
      const double m2 = system.mass2();
      const double size = std::abs(impact.before.mass1) + std::abs(impact.before.mass2) + std::abs(impact.after.mass1) +
                          std::abs(impact.after.mass2);
      // A few roundings of the largest velocity.
      const double rounding = 1e-15 * size;
      EXPECT_NEAR(m1 / (m1 + m2) * (impact.after.mass1 - impact.before.mass1) +
                      m2 / (m1 + m2) * (impact.after.mass2 - impact.before.mass2),
                  0, rounding);
      const double relative = impact.before.mass2 - impact.before.mass1;
      EXPECT_NEAR(impact.after.mass2 - impact.after.mass1, -system.restitution() * relative, 4 * rounding);
      EXPECT_NEAR(impact.energy_loss, backlash::impact_energy_loss(system, relative),
                  1e-12 * impact.energy_loss + 1e-300 + m1 * m2 / (m1 + m2) * rounding * size);
      // The masses meet: towards the wall before.
      EXPECT_LE(impact.wall == Wall::near ? relative : -relative, rounding);
      EXPECT_GE(impact.time, last);
      last = impact.time;
    }
  }
  EXPECT_GT(impacts, 2000u);
}

TEST(ImpactSimulation, ImpactsLoseWhatTheForceSupplies) {
  // Over a closed orbit the losses equal the work of the force, -pi F^2 Im N2 per period.
  const double force = 40;
  for (const double omega : {3.0, 16.4, 18.0, 20.0}) {
    const TwoMassSystem system(2, 0.7, 0.3, 0.6);
    const double scaled = omega * std::sqrt(1 / 0.7);
    backlash::SweepOptions options;
    options.output = backlash::Output::x2;
    options.protocol = backlash::Protocol::mid_gap_at_rest;
    const auto sweep = backlash::describing_function_sweep(system, force, {scaled}, options);
    const auto& point = sweep.points.front();
    ASSERT_GE(point.period, 1) << omega;
    // Two thousand periods from the same start are past the transient; then one orbit.
    const ImpactHistory transient = simulate_impacts(system, force, scaled, {0.15, 0}, 2000);
    const ImpactHistory orbit = simulate_impacts(system, force, scaled, transient.end, point.period);
    double loss = 0;
    for (const Impact& impact : orbit.impacts) loss += impact.energy_loss;
    for (const backlash::Rest& rest : orbit.rests) loss += rest.chatter_energy_loss;
    // An energy over an orbit that repeats to 1e-12; during the chatter that is cut off the force is taken as constant.
    EXPECT_NEAR(loss / (-pi * force * force * point.value.imag() * point.period), 1, 1e-10) << omega;
  }
}

TEST(ImpactSimulation, RestsEndWhenTheForceReverses) {
  const TwoMassSystem system(1, 1, 0.3, 0.3);
  const double omega = 3;
  const ImpactHistory history = simulate_impacts(system, 40, omega, {0, 0}, 5);
  ASSERT_GE(history.rests.size(), 8u);
  for (const backlash::Rest& rest : history.rests) {
    EXPECT_LT(rest.from, rest.to);
    if (rest.to == history.duration) continue;
    // Pressed at the near contact while F cos < 0, until it turns positive; the other way round at the far one.
    EXPECT_NEAR(std::cos(omega * rest.to), 0, 1e-12);
    const double slope = -std::sin(omega * rest.to);
    EXPECT_NEAR(slope, rest.wall == Wall::near ? 1 : -1, 1e-12);
  }
}

TEST(ImpactSimulation, EndStateContinuesTheMotion) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const ImpactHistory whole = simulate_impacts(system, 40, 15, {0.15, 0}, 4);
  const ImpactHistory first = simulate_impacts(system, 40, 15, {0.15, 0}, 2);
  const ImpactHistory second = simulate_impacts(system, 40, 15, first.end, 2);
  ASSERT_EQ(whole.impacts.size(), first.impacts.size() + second.impacts.size());
  // Rounding of the state at the seam, grown over the few impacts that follow.
  EXPECT_NEAR(whole.end.position, second.end.position, 1e-13);
  EXPECT_NEAR(whole.impacts.back().time, first.duration + second.impacts.back().time, 1e-13);
}

TEST(ImpactSimulation, StopsAtTheLimitOfImpactsAndSaysSo) {
  const ImpactHistory history = simulate_impacts(TwoMassSystem(1, 1, 0.3, 1), 40, 1, {0.15, 0}, 1000, 100);
  EXPECT_FALSE(history.complete);
  EXPECT_EQ(history.impacts.size(), 100u);
  EXPECT_EQ(history.duration, history.impacts.back().time);
}

TEST(ImpactSimulation, NamesWhatIsOutOfRange) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([&] { (void)simulate_impacts(TwoMassSystem(1, 1, 0, 0.6), 40, 1, {}, 1); },
                          {"clearance", "0"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 0, 1, {}, 1); }, {"force_amplitude"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 1, nan, {}, 1); }, {"omega"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 1, 1, {0.31, 0}, 1); }, {"start.position", "0.31"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 1, 1, {0.3, 1}, 1); }, {"start.velocity", "into"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 1, 1, {0.1, nan}, 1); }, {"start.velocity", "finite"});
  expect_invalid_argument([&] { (void)simulate_impacts(system, 1, 1, {0.1, 0}, 0); }, {"periods", "0"});
  expect_invalid_argument(
      [&] {
        (void)simulate_impacts(system, 1e300, 1e-9, {0.1, 0}, 1);
      },
      {"F/(M2 clearance omega^2)"});
}

// A mass at rest inside the gap is not at rest on the wall that the force points to.
TEST(ImpactSimulation, StartAtRestAnywhereInTheGapMovesFreely) {
  const TwoMassSystem system(1, 1, 1, 0.6);
  for (const double position : {0.01, 0.3, 0.5, 0.51, 0.7, 0.87}) {
    // F/(M2 omega^2) = 1/16: x2 - x1 swings between the start and 1/8 above it.
    const ImpactHistory history = simulate_impacts(system, 1, 4, {position, 0}, 50);
    EXPECT_TRUE(history.impacts.empty()) << position;
    EXPECT_TRUE(history.rests.empty()) << position;
    EXPECT_NEAR(history.end.position, position, 1e-12);
    EXPECT_NEAR(history.end.velocity, 0, 1e-12);
  }
}

}  // namespace
