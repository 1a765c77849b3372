// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/two_mass_system.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/impact_law.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::ImpactVelocities;
using backlash::TwoMassSystem;
using support::expect_invalid_argument;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(TwoMassSystem, NamesTheQuantityThatIsOutOfRange) {
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    expect_invalid_argument([&] { TwoMassSystem(bad, 1, 0.3, 0.6); }, {"mass1", "positive", "kg"});
    expect_invalid_argument([&] { TwoMassSystem(1, bad, 0.3, 0.6); }, {"mass2", "positive", "kg"});
  }
  for (const double bad : {-0.1, nan, infinity}) {
    expect_invalid_argument([&] { TwoMassSystem(1, 1, bad, 0.6); }, {"clearance", "not negative", "m"});
  }
  for (const double bad : {-0.1, 1.0000001, nan}) {
    expect_invalid_argument([&] { TwoMassSystem(1, 1, 0.3, bad); }, {"restitution", "[0, 1]"});
  }
  expect_invalid_argument([] { TwoMassSystem(1, 1, 0.3, -0.25); }, {"-0.25"});
}

TEST(TwoMassSystem, DimensionlessForceAndLimitFrequencyAgreeAtOneHalf) {
  // w_L^2 = 2F/(clearance M2), so gamma(w_L) = 1/2 up to a few roundings.
  const TwoMassSystem system(3, 0.7, 0.02, 0.5);
  EXPECT_NEAR(backlash::dimensionless_force(system, 11, backlash::limit_frequency(system, 11)), 0.5, 1e-15);
  EXPECT_TRUE(std::isinf(backlash::dimensionless_force(TwoMassSystem(1, 1, 0, 0.5), 1, 1)));
  EXPECT_TRUE(std::isinf(backlash::limit_frequency(TwoMassSystem(1, 1, 0, 0.5), 1)));
  for (const double bad : {0.0, -2.0, nan, infinity}) {
    expect_invalid_argument([&] { (void)backlash::dimensionless_force(system, bad, 1); }, {"force_amplitude", "N"});
    expect_invalid_argument([&] { (void)backlash::dimensionless_force(system, 1, bad); }, {"omega", "rad/s"});
    expect_invalid_argument([&] { (void)backlash::limit_frequency(system, bad); }, {"force_amplitude", "N"});
  }
}

TEST(TwoMassSystem, ImpactKeepsMomentumObeysRestitutionAndLosesEnergy) {
  support::Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const TwoMassSystem system(random.log_uniform(1e-9, 1e9), random.log_uniform(1e-9, 1e9), 0.1, random.unit());
    const ImpactVelocities before{random.uniform(-5, 5), random.uniform(-5, 5)};
    const ImpactVelocities after = backlash::post_impact_velocities(system, before);
    const double m1 = system.mass1();
    const double m2 = system.mass2();
    // Sums of two products of numbers up to 10 in magnitude, each good to a few roundings.
    const double speed_rounding = 4e-15 * 10;
    EXPECT_NEAR((m1 * (after.mass1 - before.mass1) + m2 * (after.mass2 - before.mass2)) / (m1 + m2), 0, speed_rounding);
    const double relative = before.mass1 - before.mass2;
    EXPECT_NEAR(after.mass1 - after.mass2, -system.restitution() * relative, speed_rounding);
    // The energy of the centre of mass does not change: compare in its frame, relative to the reduced mass.
    const double reduced = m1 * (m2 / (m1 + m2));
    const double e_before = reduced / 2 * relative * relative;
    const double relative_after = after.mass1 - after.mass2;
    const double e_after = reduced / 2 * relative_after * relative_after;
    EXPECT_NEAR(backlash::impact_energy_loss(system, relative) / reduced, (e_before - e_after) / reduced,
                100 * speed_rounding);
  }
}

TEST(TwoMassSystem, ImpulsesOfAnImpactTurnTheVelocitiesAsItDoes) {
  support::Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const TwoMassSystem system(random.log_uniform(1e-9, 1e9), random.log_uniform(1e-9, 1e9), 0.1, random.unit());
    const ImpactVelocities before{random.uniform(-5, 5), random.uniform(-5, 5)};
    const ImpactVelocities after = backlash::post_impact_velocities(system, before);
    const double approach = before.mass2 - before.mass1, separation = after.mass2 - after.mass1;
    // As above: velocities up to 20, each good to a few roundings.
    const double speed_rounding = 4e-15 * 20;
    const double impulse = backlash::detail::impulse_per_speed(system) * approach;
    EXPECT_NEAR(after.mass1, before.mass1 + impulse / system.mass1(), speed_rounding);
    EXPECT_NEAR(after.mass2, before.mass2 - impulse / system.mass2(), speed_rounding);
    const double jump = 1 / system.mass1() + 1 / system.mass2();
    EXPECT_NEAR(backlash::detail::speed_per_impulse(jump, system) * impulse, approach, speed_rounding);
    EXPECT_NEAR(backlash::detail::loss_ratio(system.restitution()) * (approach - separation), approach + separation,
                speed_rounding);
  }
}

}  // namespace
