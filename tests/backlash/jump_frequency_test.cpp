// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/jump_frequency.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::Discontinuity;
using backlash::find_discontinuities;
using backlash::jump_similarity_constant;
using backlash::JumpCriterion;
using backlash::TwoMassSystem;
using support::expect_invalid_argument;
using support::log_grid;

double constant(double restitution, JumpCriterion criterion) {
  return jump_similarity_constant(restitution, criterion).similarity_constant.value();
}

TEST(JumpFrequency, ClosedCriteriaAgreeWithTheTables) {
  const double rows[][3] = {
      {0.2, 2.26257, 1.42367}, {0.4, 2.75651, 1.56030}, {0.6, 3.56715, 1.65279}, {0.8, 5.32400, 1.70032}};
  for (const auto& [restitution, node, breaking] : rows) {
    EXPECT_NEAR(constant(restitution, JumpCriterion::saddle_node), node, 5.1e-6);
    EXPECT_NEAR(constant(restitution, JumpCriterion::symmetry_loss), breaking, 5.1e-6);
  }
  const double losses[][2] = {{0.2, 1.38241}, {0.4, 1.36971}, {0.6, 1.4082}, {0.8, 1.4700}};
  for (const auto& [restitution, loss] : losses) {
    // Printed to four or five digits.
    EXPECT_NEAR(constant(restitution, JumpCriterion::two_impact_loss), loss, 6e-5);
  }
  for (const double restitution : {0.0, 0.3, 1.0}) {
    EXPECT_EQ(constant(restitution, JumpCriterion::contact_at_rest), std::numbers::sqrt2);
    EXPECT_EQ(constant(restitution, JumpCriterion::mid_gap_at_rest), 2);
  }
}

TEST(JumpFrequency, SweepsMeetTheVisibleJump) {
  // Seen in a quadruple-precision sweep upwards on a grid of 0.7 %, whose points lie up to one step above the jump
  // itself.
  const double rows[][2] = {{0.2, 1.388}, {0.4, 1.397}, {0.6, 1.444}, {0.8, 1.491}, {0.95, 1.510}};
  for (const auto& [restitution, seen] : rows) {
    const double up = constant(restitution, JumpCriterion::sweep_up);
    EXPECT_LE(up, seen * 1.002) << restitution;
    EXPECT_GE(up, seen / 1.009) << restitution;
    // Hysteresis: the jump downwards lies lower, and not above the loss of the stable orbit, but for the last bit of
    // the way in which a step of the sweep throws the state off an orbit about to graze.
    const double down = constant(restitution, JumpCriterion::sweep_down);
    EXPECT_LE(down, up * (1 + 2e-6)) << restitution;
    EXPECT_LE(down, constant(restitution, JumpCriterion::two_impact_loss) * (1 + 1e-4)) << restitution;
  }
}

TEST(JumpFrequency, SweepUpBracketsTheChangeOfImpacts) {
  const double c = constant(0.6, JumpCriterion::sweep_up);
  std::vector<double> omega;
  for (int i = -8; i <= 8; ++i) omega.push_back(c * (1 + 1e-3 * (i + 0.5)));
  const auto points = backlash::describing_function_sweep({1, 1, 1, 0.6}, 1, log_grid(1.3, omega.front(), 60)).points;
  EXPECT_EQ(points.back().impacts_per_period, 3);
  std::vector<double> grid = log_grid(1.3, omega.front(), 60);
  grid.insert(grid.end(), omega.begin() + 1, omega.end());
  const auto through = backlash::describing_function_sweep({1, 1, 1, 0.6}, 1, grid).points;
  for (const auto& point : through) {
    if (point.omega < 1.42) continue;
    EXPECT_EQ(point.impacts_per_period, point.omega < c ? 3 : 2) << point.omega;
  }
}

TEST(JumpFrequency, SaysWhyThereIsNone) {
  const auto none = [](double restitution, JumpCriterion criterion) {
    const backlash::JumpFrequency jump = jump_similarity_constant(restitution, criterion);
    EXPECT_FALSE(jump.similarity_constant) << to_string(criterion);
    EXPECT_GT(jump.message.size(), 20u) << to_string(criterion);
  };
  for (const JumpCriterion criterion : {JumpCriterion::two_impact_loss, JumpCriterion::symmetry_loss,
                                        JumpCriterion::sweep_up, JumpCriterion::sweep_down}) {
    none(0, criterion);
  }
  for (const JumpCriterion criterion :
       {JumpCriterion::saddle_node, JumpCriterion::sweep_up, JumpCriterion::sweep_down}) {
    none(1, criterion);
  }
  EXPECT_FALSE(backlash::jump_frequency({1, 1, 0.3, 1}, 40, JumpCriterion::saddle_node));
}

// At small restitution the symmetric orbit of a downward sweep is lost by grazing, and nothing else attracts there: the
// sweep finds the loss to its bracket of 1e-6.
TEST(JumpFrequency, SweepingDownAtSmallRestitutionFindsTheLossByGrazing) {
  for (const double restitution : {2e-4, 7e-6, 4e-7, 5e-8, 1e-10, 1e-13}) {
    const auto down = backlash::jump_similarity_constant(restitution, JumpCriterion::sweep_down).similarity_constant;
    const auto loss =
        backlash::jump_similarity_constant(restitution, JumpCriterion::two_impact_loss).similarity_constant;
    ASSERT_TRUE(down && loss) << restitution;
    EXPECT_NEAR(*down / *loss, 1, 2e-6) << restitution;
  }
}

TEST(JumpFrequency, AtRestitutionZeroTwoImpactsRemainAtLowFrequencies) {
  const auto points = backlash::describing_function_sweep({1, 1, 1, 0}, 1, log_grid(0.01, 1.75, 50)).points;
  for (const auto& point : points) EXPECT_EQ(point.impacts_per_period, 2) << point.omega;
}

TEST(JumpFrequency, ScalesWithTheSquareRootOfForceOverMassAndClearance) {
  const TwoMassSystem system(5, 0.5, 0.02, 0.4);
  for (const JumpCriterion criterion : {JumpCriterion::two_impact_loss, JumpCriterion::contact_at_rest}) {
    EXPECT_NEAR(backlash::jump_frequency(system, 30, criterion).value() /
                    (constant(0.4, criterion) * std::sqrt(30 / 0.5 / 0.02)),
                1, 1e-15);
  }
  EXPECT_NEAR(backlash::jump_frequency(system, 30, JumpCriterion::contact_at_rest).value(),
              backlash::limit_frequency(system, 30), 1e-12);
}

TEST(JumpFrequency, NamesWhatIsOutOfRange) {
  expect_invalid_argument([] { (void)jump_similarity_constant(1.5, JumpCriterion::saddle_node); },
                          {"restitution", "1.5"});
  expect_invalid_argument([] { (void)jump_similarity_constant(0.5, JumpCriterion::largest_discontinuity); },
                          {"largest-discontinuity"});
  expect_invalid_argument(
      [] {
        (void)backlash::jump_frequency({1, 1, 0.3, 0.5}, 0, JumpCriterion::saddle_node);
      },
      {"force_amplitude"});
  expect_invalid_argument(
      [] {
        (void)backlash::jump_frequency({1, 1, 0, 0.5}, 1, JumpCriterion::saddle_node);
      },
      {"clearance"});
  for (const JumpCriterion criterion :
       {JumpCriterion::two_impact_loss, JumpCriterion::symmetry_loss, JumpCriterion::saddle_node,
        JumpCriterion::contact_at_rest, JumpCriterion::mid_gap_at_rest, JumpCriterion::sweep_up,
        JumpCriterion::sweep_down, JumpCriterion::largest_discontinuity}) {
    EXPECT_EQ(backlash::jump_criterion_from_string(to_string(criterion)), criterion);
  }
  expect_invalid_argument([] { (void)backlash::jump_criterion_from_string("bump"); },
                          {"criterion", "bump", "two-impact-loss"});
}

// A power law in omega with steps of known size and multiplicative noise.
frac::FrequencyResponseData stepped(const std::vector<double>& omega,
                                    const std::vector<std::pair<double, double>>& steps, double noise,
                                    std::uint64_t seed = 1) {
  support::Random random(seed);
  std::vector<std::complex<double>> value;
  for (const double w : omega) {
    double log_value = -1.3 * std::log(w) + 0.1 * std::log(w) * std::log(w);
    for (const auto& [at, size] : steps) log_value += w > at ? std::log1p(size) : 0;
    value.emplace_back(1, std::exp(log_value + noise * random.normal()));
  }
  return {omega, value};
}

TEST(Discontinuities, AreFoundWithTheirBracketAndSizeLargestFirst) {
  const auto omega = log_grid(5, 35, 200);
  const auto found = find_discontinuities(stepped(omega, {{10.05, 0.25}, {20.1, -0.4}}, 0));
  ASSERT_EQ(found.size(), 2u);
  EXPECT_LT(found[0].omega_lower, 20.1);
  EXPECT_GT(found[0].omega_upper, 20.1);
  // Relative to the larger side: a step to 60 % is one of 40 %, one to 125 % is one of 20 %.  Lines through six samples
  // follow the curved trend to 1e-4.
  EXPECT_NEAR(found[0].size, 0.4, 2e-4);
  EXPECT_NEAR(found[1].size, 0.2, 2e-4);
  EXPECT_NEAR(found[1].omega, 10.05, 0.05);
}

TEST(Discontinuities, AreNotSeenInSmoothOrNoisyCurves) {
  EXPECT_TRUE(find_discontinuities(stepped(log_grid(5, 35, 200), {}, 0)).empty());
  EXPECT_TRUE(find_discontinuities(stepped(log_grid(0.01, 100, 30), {}, 0)).empty());
  // 200 samples with 5 % normal scatter, twenty times: hardly ever is a chance step five standard deviations.
  std::size_t chance = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    chance += find_discontinuities(stepped(log_grid(5, 35, 200), {}, 0.05, seed)).size();
  EXPECT_LE(chance, 4000u / 50);
}

TEST(Discontinuities, StandOutOfNoise) {
  int hits = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto found = find_discontinuities(stepped(log_grid(5, 35, 200), {{12.3, 0.5}}, 0.01, seed));
    hits += !found.empty() && found[0].omega_lower < 12.3 && found[0].omega_upper > 12.3 ? 1 : 0;
  }
  // A step of 40 standard deviations is the largest one always.
  EXPECT_EQ(hits, 20);
}

TEST(Discontinuities, AcceptZerosRepeatsAndFiveSamples) {
  const std::vector<double> omega = {1, 2, 2, 3, 4, 5};
  const std::vector<std::complex<double>> value = {{0, 1}, {0, 1}, {0, 1}, {0, 1}, {0, 0}, {0, 0}};
  const auto found = find_discontinuities({omega, value});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].omega_lower, 3);
  EXPECT_EQ(found[0].omega_upper, 4);
  EXPECT_NEAR(found[0].size, 1, 1e-9);
  EXPECT_TRUE(find_discontinuities({omega, std::vector<std::complex<double>>(6, 0.0)}).empty());
  expect_invalid_argument(
      [] {
        (void)find_discontinuities({{1, 2, 2, 3, 4}, std::vector<std::complex<double>>(5, 1.0)});
      },
      {"4", "5"});
}

TEST(Discontinuities, OfASweepUpHoldTheVisibleJump) {
  for (const double restitution : {0.4, 0.6, 0.8, 0.95}) {
    const auto sweep = backlash::describing_function_sweep({1, 1, 0.3, restitution}, 40, log_grid(5, 35, 200));
    const double expected = constant(restitution, JumpCriterion::sweep_up) * std::sqrt(40 / 0.3);
    const auto found = find_discontinuities(sweep.data());
    const bool holds = std::any_of(found.begin(), found.end(), [&](const Discontinuity& jump) {
      // The grid is 1 % wide; the bracket may begin where the jump of a coarser sweep lies, a step aside.
      return jump.omega_lower < expected * 1.01 && jump.omega_upper > expected / 1.01;
    });
    EXPECT_TRUE(holds) << restitution;
  }
}

// A step of 10 % in a smooth curve counts where the samples are known to 1 %, not where they are known to 5 %.
TEST(Discontinuities, StepsWithinTheUncertaintyOfTheSamplesAreNone) {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 30; ++i) {
    omega.push_back(1 + 0.05 * i);
    value.emplace_back(1, std::pow(omega.back(), -0.5) * (i < 15 ? 1 : 1.1));
  }
  const frac::FrequencyResponseData data(omega, value);
  ASSERT_EQ(backlash::find_discontinuities(data).size(), 1u);
  std::vector<double> uncertainty;
  for (const auto& one : value) uncertainty.push_back(0.01 * one.imag());
  ASSERT_EQ(backlash::find_discontinuities(data, uncertainty).size(), 1u);
  for (double& one : uncertainty) one *= 5;
  EXPECT_TRUE(backlash::find_discontinuities(data, uncertainty).empty());
  support::expect_invalid_argument([&] { (void)backlash::find_discontinuities(data, {1, 2}); }, {"uncertainty has 2"});
  uncertainty[3] = -1;
  support::expect_invalid_argument([&] { (void)backlash::find_discontinuities(data, uncertainty); },
                                   {"uncertainty[3] is -1"});
}

}  // namespace
