// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant_contact.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"

namespace {

using backlash::CompliantContact;
using compliant_test::Integration;
using compliant_test::Machine;

// Two free bodies that meet with nothing else acting: the equations in small steps know no formula of a restitution.
TEST(FreeContact, EndsAsItsIntegrationInSmallSteps) {
  for (const double zeta : {0.0, 0.05, 0.4, 0.999, 1.0, 1.001, 2.5, 20.0}) {
    Machine machine;
    machine.mass1 = 1.3;
    machine.mass2 = 0.7;
    machine.force = 0;
    const CompliantContact contact = CompliantContact::from_frequency(300, zeta, machine.mass1, machine.mass2);
    machine.stiffness = contact.stiffness();
    machine.damping = contact.damping();
    const double speed = 0.8;
    Integration motion(machine, {0, 0, 0.5 * machine.clearance * (1 - 1e-12), speed});
    const auto until = [&](auto reached) {
      while (!reached()) motion.advance(motion.time() + 1e-5L);
    };
    until([&] { return motion.wall() != 0; });
    // From the step in which it has met to the one in which it presses no more, and back by the speed that stays.
    until([&] { return motion.wall() == 0; });
    const auto free = backlash::free_contact(contact, machine.mass1, machine.mass2);
    EXPECT_NEAR(free.frequency, 300, 300 * 4e-16);
    EXPECT_NEAR(free.damping_ratio, zeta, 4e-16 * zeta);
    // The speed is constant after separation, so that the step has no part in it.
    EXPECT_NEAR(static_cast<double>(-motion.rate()) / speed, free.restitution, 1e-14) << zeta;
    // To two steps of the loops above.
    EXPECT_NEAR(static_cast<double>(motion.time()), free.duration, 3e-5) << zeta;
    // What is left of the overlap, 2 zeta e v/wc, falls with the speed e v.
    const double left = static_cast<double>(motion.gap()) - 0.5 * machine.clearance;
    EXPECT_NEAR(left, 2 * zeta * free.restitution * speed / 300, 2e-5 * free.restitution * speed) << zeta;
  }
}

TEST(FreeContact, RestitutionAndDampingRatioAreInverse) {
  // e is exp(-2 zeta pi/2) (1 + O(zeta^2)) for small zeta, and 1/(4 zeta^2) (1 + O(ln zeta/zeta^2)) for large.
  EXPECT_NEAR(backlash::restitution_of_damping_ratio(1e-6), 1 - 1e-6 * std::acos(-1.0), 1e-11);
  EXPECT_NEAR(backlash::restitution_of_damping_ratio(1e6) * 4e12, 1, 1e-10);
  EXPECT_NEAR(backlash::restitution_of_damping_ratio(1e100) * 4e200, 1, 1e-12);
  EXPECT_EQ(backlash::restitution_of_damping_ratio(1e300), 0);
  EXPECT_NEAR(backlash::restitution_of_damping_ratio(1), std::exp(-2), 1e-16);
  EXPECT_EQ(backlash::damping_ratio_of_restitution(1), 0);
  for (double restitution = 1e-12; restitution < 1; restitution = std::min(2 * restitution, restitution + 0.01)) {
    const double zeta = backlash::damping_ratio_of_restitution(restitution);
    // d ln e/d zeta is at most pi, and ln e is rounded at its own size, below 28.
    EXPECT_NEAR(backlash::restitution_of_damping_ratio(zeta) / restitution, 1, 1e-14) << restitution;
  }
}

// Across 1 the formula changes from acos to acosh, both 0/0 there; the function does not.
TEST(FreeContact, IsSmoothAtCriticalDamping) {
  // acos(z)/sqrt(1 - z^2) = 1 - (z - 1)/3 + O((z - 1)^2): d ln e/d zeta = -2 + 2/3.
  for (const double off : {-1e-8, -1e-12, 1e-12, 1e-8})
    EXPECT_NEAR(std::log(backlash::restitution_of_damping_ratio(1 + off)), -2 - 4.0 / 3 * off, 1e-15) << off;
}

TEST(FreeContact, RefusesWhatIsNone) {
  using support::expect_invalid_argument;
  expect_invalid_argument([] { CompliantContact(0, 1); }, {"contact_stiffness is 0", "positive", "N/m"});
  expect_invalid_argument([] { CompliantContact(1, -2); }, {"contact_damping is -2", "not negative"});
  expect_invalid_argument([] { CompliantContact(NAN, 1); }, {"contact_stiffness is nan"});
  expect_invalid_argument([] { (void)CompliantContact::from_frequency(-1, 0, 1, 1); }, {"contact_frequency is -1"});
  expect_invalid_argument([] { (void)CompliantContact::from_frequency(1, -1, 1, 1); }, {"contact_ratio is -1"});
  expect_invalid_argument([] { (void)CompliantContact::from_frequency(1e200, 1, 1, 1); }, {"contact_stiffness is inf"});
  expect_invalid_argument([] { (void)backlash::damping_ratio_of_restitution(0); },
                          {"contact_restitution is 0", "(0, 1]"});
  expect_invalid_argument([] { (void)backlash::damping_ratio_of_restitution(1.1); }, {"contact_restitution is 1.1"});
}

}  // namespace
