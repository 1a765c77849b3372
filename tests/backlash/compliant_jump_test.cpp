// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_jump.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "backlash/compliant/compliant_bodies.hpp"
#include "compliant/compliant_family.hpp"
#include "compliant/compliant_orbit.hpp"
#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"

namespace {

using backlash::CompliantBodies;
using backlash::CompliantContact;
using backlash::JumpCriterion;
using backlash::detail::CompliantFlow;
using backlash::detail::CompliantOrbit;
using backlash::detail::CompliantRun;

double constant(double group, double restitution, JumpCriterion criterion) {
  return backlash::compliant_jump(group, backlash::damping_ratio_of_restitution(restitution), criterion)
      .similarity_constant.value_or(NAN);
}

// A share of the order of 1/sqrt(Lambda): differences halve where the stiffness is four times as large, and
// 2 c(4 Lambda) - c(Lambda) is in second order.
TEST(CompliantJump, TendsToThatOfTheRestitutionInFirstOrder) {
  for (const JumpCriterion criterion : {JumpCriterion::symmetry_loss, JumpCriterion::saddle_node}) {
    for (const double restitution : {0.3, 0.6, 0.8}) {
      const double hard = *backlash::jump_similarity_constant(restitution, criterion).similarity_constant;
      double last = constant(1e4, restitution, criterion);
      for (const double group : {4e4, 1.6e5}) {
        const double now = constant(group, restitution, criterion), share = std::abs(last / hard - 1);
        EXPECT_NEAR((last - hard) / (now - hard), 2, 6 * share) << restitution;
        EXPECT_LT(std::abs(2 * now - last - hard), 6 * share * share * hard) << restitution;
        last = now;
      }
    }
  }
}

// With gap, force and masses 1 at omega = w, contacts of that Lambda have k = Lambda/2.
CompliantBodies unit_bodies(double group, double restitution) {
  const double frequency = std::sqrt(group), ratio = backlash::damping_ratio_of_restitution(restitution);
  return {backlash::free_mass(1), backlash::free_mass(1), 1, CompliantContact::from_frequency(frequency, ratio, 1, 1)};
}

struct Near {
  CompliantOrbit orbit;
  backlash::LoopStart at_peak;
};
std::optional<Near> orbit_near(const CompliantBodies& bodies, double omega, const backlash::LoopStart& start,
                               int periods) {
  const CompliantFlow flow(bodies, {1, omega}, backlash::Output::x1, 1e-9, 1);
  const Eigen::VectorXd state = flow.start(start);
  CompliantRun run(flow, state, flow.mode_of(state));
  if (periods > 0 && !run.follow(periods)) return std::nullopt;
  const auto orbit = backlash::detail::closed_orbit(flow, run.state(), run.mode(), 1);
  if (!orbit) return std::nullopt;
  return Near{*orbit, CompliantFlow::positions(orbit->state)};
}

// The orbit of the flow from event to event, which knows nothing of the closed form: its multiplier crosses 1 there.
TEST(CompliantJump, IsWhereTheMultiplierOfTheFlowCrossesOne) {
  for (const auto& [group, restitution] :
       {std::pair{60.0, 0.6}, {60.0, 0.2}, {240.0, 0.4}, {960.0, 0.8}, {10.0, 0.5}}) {
    const double c = constant(group, restitution, JumpCriterion::symmetry_loss);
    const CompliantBodies bodies = unit_bodies(group, restitution);
    auto at = orbit_near(bodies, 1.06 * c, {0, 0, 0, 1}, 300);
    ASSERT_TRUE(at && at->orbit.largest_multiplier < 1) << group;
    for (const double factor : {1.04, 1.02, 1.01, 1.005}) {
      at = orbit_near(bodies, factor * c, at->at_peak, 0);
      ASSERT_TRUE(at) << group;
    }
    // Where the straight line between logarithms of the multiplier on either side is 0, from there.
    const auto zero = [&](double share) {
      const auto above = orbit_near(bodies, (1 + share) * c, at->at_peak, 0);
      const auto below = above ? orbit_near(bodies, (1 - share) * c, above->at_peak, 0) : above;
      if (!below) return std::nan("");
      EXPECT_EQ(below->orbit.contacts, 2) << group;
      const double high = std::log(above->orbit.largest_multiplier), low = std::log(below->orbit.largest_multiplier);
      EXPECT_LT(high, 0) << group;
      EXPECT_GT(low, 0) << group;
      return share * (high + low) / (low - high);
    };
    // It errs by even powers of the share, 25 share^2 at most; without the first of them 10^4 share^4 are left.
    const double coarse = zero(5e-4), fine = zero(2.5e-4);
    EXPECT_NEAR((4 * fine - coarse) / 3, 0, 1e-8) << group << " " << restitution;
  }
}

// b over force is what a secant of c says, and c of two scenes of one group is the same by definition.
TEST(CompliantJump, HasTheExponentOfItsSecant) {
  for (const JumpCriterion criterion : {JumpCriterion::symmetry_loss, JumpCriterion::saddle_node}) {
    for (const double group : {40.0, 300.0}) {
      constexpr double step = 0.02;
      const auto jump = backlash::compliant_jump(group, 0.2, criterion);
      const auto less = backlash::compliant_jump(group * std::exp(-step), 0.2, criterion);
      const auto more = backlash::compliant_jump(group * std::exp(step), 0.2, criterion);
      const double slope = std::log(*more.similarity_constant / *less.similarity_constant) / (2 * step);
      // A secant errs by step^2/6 of a third derivative of about the slope's size.
      EXPECT_NEAR(jump.exponent, 0.5 - slope, step * step);
      EXPECT_LT(jump.exponent, 0.5);
    }
  }
}

CompliantBodies rubbing(double friction1, double friction2, double frequency = 20) {
  return {backlash::free_mass(1),
          backlash::free_mass(1),
          1,
          CompliantContact::from_frequency(frequency, backlash::damping_ratio_of_restitution(0.6), 1, 1),
          {friction1, friction2}};
}

// The flow from event to event takes friction in, the closed form does not: what is left is in first order of friction.
// Of so little friction c is off by less than 4 times its share, as w is below 4 and falls to 0 where friction holds
// the force; exponents are secants over 1e-3 here, which err by its square, and 1e-9 of c over twice that.
TEST(CompliantJump, OfLittleFrictionIsThatOfTheClosedForm) {
  for (const JumpCriterion criterion : {JumpCriterion::symmetry_loss, JumpCriterion::saddle_node}) {
    const auto free = backlash::compliant_jump(400, backlash::damping_ratio_of_restitution(0.6), criterion);
    constexpr double share = 1e-8;
    const auto jump = backlash::compliant_jump(rubbing(share, share / 2), 1, criterion);
    EXPECT_NEAR(*jump.similarity_constant, *free.similarity_constant, 4 * 1.5 * share);
    EXPECT_NEAR(jump.exponent, free.exponent, 2e-6);
    EXPECT_NEAR(jump.clearance_exponent, -free.exponent, 2e-6);
    EXPECT_EQ(jump.message, free.message);
  }
}

// The multiplier of largest modulus of the map over half a period, turned over, by differences of an integration in
// small steps that knows neither flow nor orbit: -1 where the symmetry breaks, 1 at the fold, where it comes as the
// square root of what c is off by.
TEST(CompliantJump, WithFrictionIsWhereAnIntegrationSaysSo) {
  using compliant_test::Integration;
  constexpr int states = 3;  // gap, its rate, v1: nothing holds x1
  for (const auto& [friction1, friction2] : {std::pair{0.1, 0.0}, {0.0, 0.2}, {0.05, 0.1}}) {
    for (const JumpCriterion criterion : {JumpCriterion::symmetry_loss, JumpCriterion::saddle_node}) {
      const CompliantBodies bodies = rubbing(friction1, friction2);
      const auto jump = backlash::compliant_jump(bodies, 1, criterion, false);
      ASSERT_TRUE(jump.similarity_constant) << jump.message;
      EXPECT_TRUE(std::isnan(jump.exponent));
      const bool is_low = criterion == JumpCriterion::symmetry_loss;
      const double omega = *jump.similarity_constant * (is_low ? 1 : 1 - 1e-8);
      // The orbit there, by way of those between it and one that the restitution leads to.
      const backlash::detail::CompliantFamily family(bodies, 1, omega, backlash::OrbitParameter::omega,
                                                     backlash::Output::x1);
      auto orbit = family.from_hard(std::log(2.0));
      ASSERT_TRUE(orbit);
      for (const double closeness : {0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4, 1e-5, 1e-6, 0.0}) {
        const double value = closeness * std::log(2.0) + (1 - closeness) * std::log(omega);
        orbit = backlash::detail::closed_motion(family.map(), orbit->state(), orbit->mode, value, 1);
        ASSERT_TRUE(orbit) << closeness;
      }
      const CompliantFlow flow = family.flow(std::log(omega));
      const backlash::LoopStart at = CompliantFlow::positions(family.placed(flow, orbit->state()));
      compliant_test::Machine machine;
      machine.clearance = machine.force = 1;
      machine.stiffness = bodies.contact().stiffness();
      machine.damping = bodies.contact().damping();
      machine.coulomb1 = friction1;
      machine.coulomb2 = friction2;
      machine.omega = omega;
      const auto half = [&](const Eigen::Vector3d& z) {
        Integration motion(machine, {0, z[2], z[0], z[1] + z[2]});
        motion.advance(std::numbers::pi_v<long double> / omega);
        return Eigen::Vector3d(-Eigen::Vector3d(static_cast<double>(motion.gap()), static_cast<double>(motion.rate()),
                                                static_cast<double>(motion.state()[Integration::v1])));
      };
      const Eigen::Vector3d start(at.x2 - at.x1, at.v2 - at.v1, at.v1);
      // The orbit is known to 1e-10 of its sizes.
      EXPECT_LT((half(start) - start).norm(), 1e-8);
      constexpr double step = 1e-5;
      Eigen::Matrix3d derivative;
      for (Eigen::Index k = 0; k < states; ++k) {
        const Eigen::Vector3d change = step * Eigen::Vector3d::Unit(k);
        derivative.col(k) = (half(start + change) - half(start - change)) / (2 * step);
      }
      // Differences err by the square of the step, and where friction turns a body by the step.  The determinant of the
      // derivative less the multiplier vanishes in first order of what that is off by.
      const double multiplier = is_low ? -1 : 1;
      const double determinant = (derivative - multiplier * Eigen::Matrix3d::Identity()).determinant();
      EXPECT_NEAR(determinant, 0, is_low ? 1e-4 : 1e-2) << friction1 << " " << friction2;
    }
  }
}

// Forces, stiffness and friction multiplied alike, damping with them and the mass: the same motion in other units.
TEST(CompliantJump, DependsOnItsGroupsAlone) {
  const double mass = 3, clearance = 0.2, force = 50;
  const double rate = std::sqrt(force / (mass * clearance));
  const CompliantContact unit = CompliantContact::from_frequency(15, 0.25, 2, 1);
  const CompliantBodies one{backlash::free_mass(2), backlash::free_mass(1), 1, unit, {0.07, 0.03}};
  const CompliantBodies other{backlash::free_mass(2 * mass),
                              backlash::free_mass(mass),
                              clearance,
                              CompliantContact(unit.stiffness() * mass * rate * rate, unit.damping() * mass * rate),
                              {0.07 * force, 0.03 * force}};
  for (const JumpCriterion criterion : {JumpCriterion::symmetry_loss, JumpCriterion::saddle_node}) {
    const auto a = backlash::compliant_jump(one, 1, criterion, false);
    const auto b = backlash::compliant_jump(other, force, criterion, false);
    // Ends are located to 1e-12 but for what Newton's method leaves of the state.
    EXPECT_NEAR(*a.similarity_constant, *b.similarity_constant, 1e-9);
    EXPECT_NEAR(a.stiffness_group, b.stiffness_group, 1e-9);
  }
}

TEST(CompliantJump, RefusesWhatItCannotBe) {
  const CompliantBodies sprung{frac::FractionalTransferFunction({{1, 0}}, {{1, 2}, {1, 0}}),
                               backlash::free_mass(1),
                               1,
                               CompliantContact(100, 1),
                               {0.1, 0}};
  support::expect_invalid_argument([&] { (void)backlash::compliant_jump(sprung, 1, JumpCriterion::symmetry_loss); },
                                   {"free masses"});
  using support::expect_invalid_argument;
  expect_invalid_argument([] { (void)backlash::compliant_jump(0, 0.1, JumpCriterion::symmetry_loss); },
                          {"stiffness_group is 0"});
  expect_invalid_argument([] { (void)backlash::compliant_jump(10, 0, JumpCriterion::symmetry_loss); },
                          {"damping_ratio is 0"});
  expect_invalid_argument([] { (void)backlash::compliant_jump(10, 0.1, JumpCriterion::sweep_up); },
                          {"criterion is sweep-up", "symmetry-loss or saddle-node"});
  const CompliantContact contact(100, 1);
  EXPECT_DOUBLE_EQ(backlash::stiffness_group(contact, 2, 3, 0.5, 10), 100 * 0.5 / 10 * (3 / (2 * 3 / 5.0)));
  expect_invalid_argument([&] { (void)backlash::stiffness_group(contact, 1, 1, 0, 10); }, {"clearance is 0"});
  // Contacts so soft that bodies never leave them.
  const auto soft = backlash::compliant_jump(1e-3, 0.2, JumpCriterion::symmetry_loss);
  EXPECT_FALSE(soft.similarity_constant);
  EXPECT_NE(soft.message.find("no symmetric orbit"), std::string::npos);
}

}  // namespace
