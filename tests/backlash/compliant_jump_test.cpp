// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_jump.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "backlash/compliant/compliant_bodies.hpp"
#include "compliant/compliant_orbit.hpp"
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

TEST(CompliantJump, RefusesWhatItCannotBe) {
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
