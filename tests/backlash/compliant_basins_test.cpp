// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_basins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "backlash/compliant/compliant_history.hpp"
#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::BasinMap;
using backlash::CompliantBodies;
using backlash::CompliantContact;
using support::linear_grid;

CompliantBodies free_bodies(double frequency, double restitution, const backlash::CoulombFriction& friction = {}) {
  return {backlash::free_mass(1), backlash::free_mass(1), 1,
          CompliantContact::from_frequency(frequency, backlash::damping_ratio_of_restitution(restitution), 1, 1),
          friction};
}

/// Distance in value of the nearest attractor with as many impacts, over its value.
double distance(const backlash::Attractor& of, const BasinMap& from) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& other : from.attractors) {
    if (other.point.period != of.point.period || other.point.impacts_per_period != of.point.impacts_per_period)
      continue;
    if (other.symmetric != of.symmetric) continue;
    least = std::min(least, std::abs(other.point.value - of.point.value) / std::abs(of.point.value));
  }
  return least;
}

// Below the pitchfork at 1.653 two asymmetric orbits of two impacts mirror each other.  As contacts become faster at
// one restitution their N tends to that of hard contacts in first order of omega/wc.
TEST(CompliantBasins, TendToThoseOfARestitution) {
  constexpr double omega = 1.5;
  const auto position = linear_grid(0.02, 0.98, 6), velocity = linear_grid(-1, 1, 6);
  const BasinMap hard = backlash::basins({1, 1, 1, 0.6}, 1, omega, position, velocity);
  const BasinMap soft = backlash::basins(free_bodies(200 * omega, 0.6), 1, omega, position, velocity);
  const BasinMap stiff = backlash::basins(free_bodies(400 * omega, 0.6), 1, omega, position, velocity);
  ASSERT_EQ(stiff.attractors.size(), hard.attractors.size());
  ASSERT_EQ(soft.attractors.size(), hard.attractors.size());
  EXPECT_GE(hard.attractors.size(), 2u);
  for (const auto& attractor : hard.attractors) {
    const double of_soft = distance(attractor, soft), of_stiff = distance(attractor, stiff);
    EXPECT_GT(of_soft, 1e-5);
    // The next term moves the ratio 2 of differences by a few times the difference itself.
    EXPECT_NEAR(of_soft / of_stiff, 2, 10 * of_soft);
  }
}

// The integration of each start in small steps has come to the attractor's N when e^-30 of its distance is left.
TEST(CompliantBasins, StartsLeadWhereAnIntegrationDoes) {
  int compared = 0;
  struct Case {
    double frequency, restitution, omega, friction1, friction2;
  };
  for (const Case& c :
       {Case{8, 0.4, 1.3, 0, 0}, Case{10, 0.3, 1.7, 0, 0}, Case{6, 0.5, 1.4, 0.1, 0}, Case{8, 0.4, 2.1, 0.05, 0.05},
        Case{7, 0.2, 1.9, 0, 0}, Case{9, 0.1, 1.1, 0, 0}, Case{8, 0.2, 1.6, 0.2, 0.1}}) {
    const CompliantBodies bodies = free_bodies(c.frequency, c.restitution, {c.friction1, c.friction2});
    const std::vector<double> position{0, 0.6}, velocity{0.7};
    const BasinMap map = backlash::basins(bodies, 1, c.omega, position, velocity);
    EXPECT_TRUE(map.attracts());
    compliant_test::Machine machine;
    machine.clearance = machine.force = 1;
    machine.omega = c.omega;
    machine.stiffness = bodies.contact().stiffness();
    machine.damping = bodies.contact().damping();
    machine.coulomb1 = c.friction1;
    machine.coulomb2 = c.friction2;
    for (std::size_t i = 0; i < position.size(); ++i) {
      for (std::size_t k = 0; k < velocity.size(); ++k) {
        const auto& point = map.at(i, k).point;
        ASSERT_NE(point.regime, backlash::Regime::averaged);
        // Others would take too long.
        if (!(point.lyapunov_exponent < -0.15)) continue;
        ++compared;
        compliant_test::Integration motion(
            machine, backlash::start_about_mean(bodies.system(), 1, c.omega, {position[i], velocity[k]}));
        const long double period = 2 * std::numbers::pi_v<long double> / c.omega;
        // Ten periods until the motion is near.
        const int transient = 10 + static_cast<int>(std::ceil(30 / -std::max(-30.0, point.lyapunov_exponent)));
        motion.advance(transient * period);
        static_cast<void>(motion.take_value(1));
        motion.advance((transient + point.period) * period);
        EXPECT_LT(std::abs(point.value - motion.take_value(point.period)), 1e-9 * std::abs(point.value))
            << c.frequency << " start " << i << ' ' << k;
      }
    }
  }
  EXPECT_GE(compared, 6);
}

// Undamped contacts take no energy, dry friction does.
TEST(CompliantBasins, AttractWhereEnergyIsLost) {
  const CompliantContact spring(100, 0);
  const auto body = backlash::free_mass(1);
  EXPECT_FALSE(backlash::basins({body, body, 1, spring}, 1, 4, {0.5}, {0}).attracts());
  EXPECT_TRUE(backlash::basins({body, body, 1, spring, {0.1, 0}}, 1, 4, {0.5}, {0}).attracts());
}

TEST(CompliantBasins, NamesWhatIsOutOfRange) {
  const CompliantBodies bodies = free_bodies(20, 0.5);
  support::expect_invalid_argument([&] { (void)backlash::basins(bodies, 1, 1, {1.5}, {0}); }, {"position[0] is 1.5"});
  support::expect_invalid_argument([&] { (void)backlash::basins(bodies, 0, 1, {0.5}, {0}); }, {"force_amplitude"});
  support::expect_invalid_argument([&] { (void)backlash::basins(bodies, 1, 0, {0.5}, {0}); }, {"omega"});
}

}  // namespace
