// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/expect_invalid_argument.hpp"

namespace {

using backlash::fit_jump_law;
using backlash::JumpCriterion;
using backlash::JumpLaw;
using support::expect_invalid_argument;

const std::vector<double> forces = {10, 20, 30, 40, 50};
const std::vector<double> clearances = {.01, .025, .05, .1, .2, .3, .4, .5};
const std::vector<double> restitutions = {0, .2, .4, .6, .8, 1};

TEST(JumpLaw, OfTheIdealModelIsTheSimilarityLaw) {
  for (const JumpCriterion criterion :
       {JumpCriterion::two_impact_loss, JumpCriterion::symmetry_loss, JumpCriterion::contact_at_rest,
        JumpCriterion::mid_gap_at_rest, JumpCriterion::saddle_node, JumpCriterion::sweep_up}) {
    const double mass2 = 0.7;
    const JumpLaw law = fit_jump_law(2, mass2, forces, clearances, restitutions, criterion);
    EXPECT_EQ(law.criterion, criterion);
    ASSERT_EQ(law.points.size(), forces.size() * clearances.size() * restitutions.size());
    ASSERT_EQ(law.laws.size(), clearances.size());
    // Exact power laws: least squares of rounded logarithms.
    for (const auto& each : law.laws) {
      EXPECT_NEAR(each.law.exponent, 0.5, 1e-12);
      EXPECT_NEAR(each.law.coefficient * std::sqrt(mass2 * each.clearance) / law.mean_similarity_constant, 1, 1e-12);
    }
    EXPECT_NEAR(law.a_of_clearance.exponent, -0.5, 1e-12);
    EXPECT_NEAR(law.a_of_clearance.coefficient * std::sqrt(mass2) / law.mean_similarity_constant, 1, 1e-12);
    EXPECT_NEAR(law.b_of_clearance.exponent, 0, 1e-12);
    EXPECT_NEAR(law.b_of_clearance.coefficient, 0.5, 1e-12);
  }
}

TEST(JumpLaw, AveragesOverTheRestitutionsThatHaveAJump) {
  const JumpLaw law = fit_jump_law(1, 1, forces, clearances, restitutions, JumpCriterion::two_impact_loss);
  double sum = 0;
  int count = 0;
  for (const double restitution : restitutions) {
    const auto c = backlash::jump_similarity_constant(restitution, JumpCriterion::two_impact_loss).similarity_constant;
    if (!c) continue;
    sum += *c;
    ++count;
  }
  EXPECT_EQ(count, 5);
  EXPECT_NEAR(law.mean_similarity_constant, sum / count, 1e-12);
  std::size_t empty = 0;
  for (const auto& point : law.points) {
    if (point.omega_jump) continue;
    ++empty;
    EXPECT_EQ(point.restitution, 0);
  }
  EXPECT_EQ(empty, forces.size() * clearances.size());
}

TEST(JumpLaw, FromDataAloneScattersAboutTheSimilarityLawByTheWidthOfItsGrid) {
  const JumpLaw law = fit_jump_law(1, 1, {10, 40}, {.1, .3}, {.4, .6, .8}, JumpCriterion::largest_discontinuity);
  const JumpLaw exact = fit_jump_law(1, 1, {10, 40}, {.1, .3}, {.4, .6, .8}, JumpCriterion::sweep_up);
  EXPECT_NEAR(law.mean_similarity_constant, exact.mean_similarity_constant, 0.01 * exact.mean_similarity_constant);
  for (const auto& each : law.laws) EXPECT_NEAR(each.law.exponent, 0.5, 0.01);
}

TEST(JumpLaw, DoesNotDependOnTheNumberOfThreads) {
  frac::Progress progress;
  const JumpLaw one =
      fit_jump_law(1, 1, {10, 40}, {.1, .3}, {.6, .8}, JumpCriterion::largest_discontinuity, 1, &progress);
  const JumpLaw three = fit_jump_law(1, 1, {10, 40}, {.1, .3}, {.6, .8}, JumpCriterion::largest_discontinuity, 3);
  EXPECT_EQ(progress.done, 8u);
  EXPECT_EQ(progress.total, 8u);
  for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(one.points[i].omega_jump, three.points[i].omega_jump);
}

TEST(JumpLaw, PublishedConstantsGiveThePublishedFrequency) {
  // 1.193 * 0.3^-0.564 * 40^(0.565 * 0.3^0.024), by hand.
  const double a = 1.193 * std::exp(-0.564 * std::log(0.3));
  const double b = 0.565 * std::exp(0.024 * std::log(0.3));
  EXPECT_NEAR(backlash::PublishedJumpLaw{}.omega_jump(40, 0.3), a * std::exp(b * std::log(40.0)), 1e-12);
  // The range of c on the published grid of forces and clearances, printed to four digits.
  double least = 10;
  double largest = 0;
  for (const double force : forces) {
    for (const double clearance : clearances) {
      const double c = backlash::PublishedJumpLaw{}.omega_jump(force, clearance) / std::sqrt(force / clearance);
      least = std::min(least, c);
      largest = std::max(largest, c);
    }
  }
  EXPECT_NEAR(least, 1.418, 6e-4);
  EXPECT_NEAR(largest, 1.639, 6e-4);
}

TEST(JumpLaw, NamesWhatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const JumpCriterion criterion = JumpCriterion::contact_at_rest;
  expect_invalid_argument([&] { (void)fit_jump_law(0, 1, forces, clearances, {.5}, criterion); }, {"mass1"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, nan, forces, clearances, {.5}, criterion); }, {"mass2"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, 1, {10}, clearances, {.5}, criterion); },
                          {"force has 1 value; at least 2 different ones are needed"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, 1, forces, {.1}, {.5}, criterion); },
                          {"clearance", "at least 2"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, 1, forces, clearances, {}, criterion); },
                          {"restitution", "at least 1"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, 1, {10, -1}, clearances, {.5}, criterion); }, {"force[1]", "-1"});
  expect_invalid_argument([&] { (void)fit_jump_law(1, 1, forces, {.1, 0}, {.5}, criterion); }, {"clearance[1]"});
  expect_invalid_argument(
      [&] {
        (void)fit_jump_law(1, 1, forces, clearances, {.5, 1.5}, criterion);
      },
      {"restitution[1]", "1.5"});
  expect_invalid_argument(
      [&] {
        (void)fit_jump_law(1, 1, {10, 10}, clearances, {.5}, criterion);
      },
      {"every force is 10", "at least 2 different"});
  // One scene is enough for the constants.
  expect_invalid_argument([&] { (void)backlash::jump_grid(1, 1, {}, {.1}, {.5}, criterion); },
                          {"force has 0 values; at least 1 is needed"});
}

TEST(JumpLaw, WithoutAnyJumpThereIsNoLawAndAReason) {
  const JumpLaw law = fit_jump_law(1, 1, forces, clearances, {1}, JumpCriterion::saddle_node);
  EXPECT_NE(law.message.find("saddle-node"), std::string::npos) << law.message;
  EXPECT_TRUE(law.laws.empty());
  EXPECT_TRUE(std::isnan(law.a_of_clearance.coefficient) && std::isnan(law.mean_similarity_constant));
  ASSERT_EQ(law.constants.size(), 1u);
  EXPECT_FALSE(law.constants[0].similarity_constant);
  EXPECT_NE(law.constants[0].message.find("without dissipation"), std::string::npos);
}

TEST(JumpLaw, SaysWhatEachRestitutionGivesToTheMean) {
  const JumpLaw law = fit_jump_law(1, 2, forces, clearances, {0, 0.05, 0.6, 1}, JumpCriterion::two_impact_loss);
  EXPECT_TRUE(law.message.empty());
  ASSERT_EQ(law.constants.size(), 4u);
  double sum = 0;
  for (const auto& constant : law.constants) {
    const auto expected = backlash::jump_similarity_constant(constant.restitution, JumpCriterion::two_impact_loss);
    EXPECT_EQ(constant.similarity_constant, expected.similarity_constant);
    EXPECT_EQ(constant.message, expected.message);
    sum += constant.similarity_constant.value_or(0);
  }
  // At restitution 0 two impacts remain at every lower frequency; below 0.0867 an extra impact ends the symmetric
  // orbit.
  EXPECT_FALSE(law.constants[0].similarity_constant);
  EXPECT_NE(law.constants[1].message.find("extra impact"), std::string::npos);
  EXPECT_NE(law.constants[3].message.find("no motion is attracted"), std::string::npos);
  EXPECT_NEAR(law.mean_similarity_constant, sum / 3, 1e-12);
}

}  // namespace
