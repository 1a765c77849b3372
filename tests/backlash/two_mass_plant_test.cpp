// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/two_mass_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "backlash/impact_simulation.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/observed_order.hpp"
#include "support/random.hpp"

namespace {

using backlash::TwoMassPlant;
using backlash::TwoMassState;
using backlash::TwoMassSystem;

constexpr double pi = std::numbers::pi;

TEST(TwoMassPlant, FliesAlongParabolas) {
  TwoMassPlant plant(TwoMassSystem(1, 2, 10, 0.5),
                     {.position1 = 1, .velocity1 = 0.25, .position2 = 4, .velocity2 = -0.5});
  plant.advance(3, 0.5);
  plant.advance(-1, 0.25);
  // Mass 1 is free; mass 2: -0.5 + 1.5 * 0.5 = 0.25, then 0.25 - 0.5 * 0.25.
  const TwoMassState state = plant.state();
  EXPECT_NEAR(state.position1, 1 + 0.25 * 0.75, 1e-15);
  EXPECT_NEAR(state.velocity1, 0.25, 1e-15);
  EXPECT_NEAR(state.position2, 4 - 0.5 * 0.5 + 0.5 * 1.5 * 0.25 + 0.25 * 0.25 - 0.5 * 0.5 * 0.0625, 4e-15);
  EXPECT_NEAR(state.velocity2, 0.125, 1e-15);
  EXPECT_EQ(plant.impacts(), 0);
}

TEST(TwoMassPlant, AnImpactObeysRestitutionAndKeepsMomentum) {
  const TwoMassSystem system(1.5, 0.7, 0.2, 0.6);
  // Mass 2 crosses the 0.2 m at 2 m/s without a force: contact after exactly 0.1 s at the far wall.
  TwoMassPlant plant(system, {.position1 = 0, .velocity1 = 0, .position2 = 0, .velocity2 = 2});
  plant.advance(0, 0.15);
  const auto after = post_impact_velocities(system, {0, 2});
  EXPECT_EQ(plant.impacts(), 1);
  EXPECT_NEAR(plant.state().velocity1, after.mass1, 1e-15);
  EXPECT_NEAR(plant.state().velocity2, after.mass2, 1e-15);
  EXPECT_NEAR(plant.state().position1, after.mass1 * 0.05, 1e-15);
  EXPECT_NEAR(plant.energy_loss(), impact_energy_loss(system, 2), 1e-15);
}

// Random forces, clearances and restitutions: momentum is the impulse of the force, energy its work less the losses,
// and the masses stay within the clearance.
TEST(TwoMassPlant, KeepsItsBalancesAndNeverPenetrates) {
  support::Random random(1);
  for (int scene = 0; scene < 200; ++scene) {
    const TwoMassSystem system(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(1e-3, 1),
                               scene % 5 == 0   ? 1
                               : scene % 7 == 0 ? 0
                                                : random.unit());
    TwoMassPlant plant(system);
    double impulse = 0, work = 0, turnover = 0;
    for (int n = 0; n < 300; ++n) {
      const double force = n % 13 == 0 ? 0 : random.uniform(-20, 20);
      const double duration = random.log_uniform(1e-4, 0.2);
      const double from = plant.state().position2;
      plant.advance(force, duration);
      const TwoMassState state = plant.state();
      impulse += force * duration;
      work += force * (state.position2 - from);
      turnover += std::abs(force) * (std::abs(state.position2) + std::abs(from)) + std::abs(force * duration);
      ASSERT_GE(plant.gap(), 0);
      ASSERT_LE(plant.gap(), system.clearance());
      // Sums of 300 terms: some hundred roundings of what has been turned over.
      ASSERT_NEAR(plant.momentum(), impulse, 1e-13 * (1 + turnover));
      ASSERT_NEAR(system.mass1() * state.velocity1 + system.mass2() * state.velocity2, plant.momentum(),
                  1e-13 * (1 + std::abs(plant.momentum())));
      ASSERT_NEAR(plant.kinetic_energy() + plant.energy_loss(), work, 1e-12 * (1 + turnover)) << scene << " " << n;
    }
  }
}

// Pressed together, a hop with 1 m/s goes on for 2 v/(a (1 - e)) seconds; with e = 0.9 and a = 5 m/s^2 that is 4 s.
TEST(TwoMassPlant, ChatterEndsInRestAfterTheGeometricSeries) {
  const TwoMassSystem system(1, 1, 10, 0.9);
  for (const int samples : {1, 7, 1000}) {
    TwoMassPlant plant(system, {.position1 = 0, .velocity1 = 0, .position2 = 0, .velocity2 = 1});
    for (int n = 0; n < samples; ++n) plant.advance(-5, 3.999 / samples);
    EXPECT_FALSE(plant.in_contact()) << samples;
    plant.advance(-5, 0.002);
    EXPECT_TRUE(plant.in_contact()) << samples;
    EXPECT_EQ(plant.gap(), 0);
    EXPECT_EQ(plant.gap_rate(), 0);
    // All of the relative energy is lost; the force does no work on closed hops.
    EXPECT_NEAR(plant.energy_loss(), 0.25, 1e-12);
    plant.advance(-5, 100);
    EXPECT_TRUE(plant.in_contact());
    // The force turns: the masses part at once, mass 2 by a t^2/2 against mass 1.
    plant.advance(5, 0.5);
    EXPECT_NEAR(plant.gap(), 0.5 * 5 * 0.25, 1e-12);
  }
}

TEST(TwoMassPlant, NothingHangs) {
  // Almost elastic and hard pressed: 10^9 hops in a second.
  TwoMassPlant hopping(TwoMassSystem(1, 1, 1, 1 - 1e-12), {.velocity2 = 5e-9});
  hopping.advance(-10, 1);
  EXPECT_FALSE(hopping.in_contact());
  EXPECT_NEAR(hopping.energy_loss(), 0, 1e-19);
  EXPECT_LE(hopping.gap(), 0.5 * 5e-9 * 1e-9);
  TwoMassPlant elastic(TwoMassSystem(1, 1, 1, 1), {.velocity2 = 1e-300});
  elastic.advance(-10, 1);
  EXPECT_GE(elastic.gap(), 0);
  TwoMassPlant plastic(TwoMassSystem(1, 1, 0.3, 0));
  for (int n = 0; n < 1000; ++n) plastic.advance(n % 2 == 0 ? 10 : -10, 0.3);
  EXPECT_TRUE(std::isfinite(plastic.kinetic_energy()));
  support::expect_invalid_argument(
      [] {
        TwoMassPlant fast(TwoMassSystem(1, 1, 1e-6, 1), {.velocity2 = 100});
        fast.advance(0, 1);
      },
      {"duration is 1 s", "1e7 times"});
}

TEST(TwoMassPlant, WithoutClearanceTheMassesAreOne) {
  TwoMassPlant plant(TwoMassSystem(1, 3, 0, 0.5), {.velocity1 = 1, .velocity2 = 2});
  EXPECT_NEAR(plant.energy_loss(), 0.5 * 0.75 * 1, 1e-15);
  plant.advance(8, 0.5);
  EXPECT_TRUE(plant.in_contact());
  EXPECT_NEAR(plant.state().velocity1, 1.75 + 1, 1e-15);
  EXPECT_EQ(plant.state().velocity1, plant.state().velocity2);
  EXPECT_EQ(plant.state().position1, plant.state().position2);
}

// The force F cos(omega t) taken at the middle of each sample: second order in the sample, against exact flights under
// the sine itself, on the stable orbit with two impacts per period.
TEST(TwoMassPlant, TendsToTheMotionUnderASine) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const double omega = 20, force = 40;  // F/(M2 clearance omega^2) = 1/3
  const backlash::RelativeState start{.position = 0.1, .velocity = 0.5};
  const int periods = 2;
  const auto exact = simulate_impacts(system, force, omega, start, periods);
  ASSERT_GE(exact.impacts.size(), 2);
  const auto error = [&](int per_period) {
    TwoMassPlant plant(system, {.position2 = start.position, .velocity2 = start.velocity});
    const double duration = 2 * pi / omega / per_period;
    for (int n = 0; n < periods * per_period; ++n)
      plant.advance(force * std::cos(omega * duration * (n + 0.5)), duration);
    EXPECT_EQ(plant.impacts(), exact.impacts.size());
    return std::abs(plant.gap() - exact.end.position);
  };
  const double coarse = error(500), fine = error(1000);
  EXPECT_LT(fine, 1e-5);
  // An impact inside a sample meets a force that is off by the first order there, so single errors fluctuate about it.
  EXPECT_NEAR(support::observed_order(error(250), error(4000)) / 4, 2, 0.35);
  EXPECT_LT(fine, coarse);
}

TEST(TwoMassPlant, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const auto refused = [&](const TwoMassState& start, const std::string& part) {
    support::expect_invalid_argument([&] { TwoMassPlant plant(system, start); }, {part});
  };
  refused({.position1 = nan}, "start.position1 is nan");
  refused({.velocity2 = INFINITY}, "start.velocity2 is inf");
  refused({.position2 = 0.4}, "it must be in [0, clearance = 0.3]");
  refused({.position2 = -0.1}, "is -0.1");
  TwoMassPlant plant(system);
  support::expect_invalid_argument([&] { plant.advance(nan, 1); }, {"force is nan"});
  support::expect_invalid_argument([&] { plant.advance(1, -1); }, {"duration is -1"});
}

}  // namespace
