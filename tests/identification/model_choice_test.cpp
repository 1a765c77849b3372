// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/model_choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>
#include <stdexcept>
#include <vector>

#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"

namespace {

using support::both_parts;
using support::noisy_response;

// White residuals give p uniform in (0, 1): of 100 seeds, 5 +- 2.2 fall below 5 % and four deviations are 14.  A
// missing term gives p far below.
TEST(ResidualWhiteness, TellsNoiseFromShape) {
  const frac::Structure lag("K/(T s^a + 1)");
  int small = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, seed);
    small += frac::residual_whiteness(data, both_parts(), frac::fit(data, lag, both_parts())).p_value < 0.05;
  }
  EXPECT_LE(small, 14);
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 1);
  const auto missed =
      frac::residual_whiteness(data, both_parts(), frac::fit(data, frac::Structure("K/(T s + 1)"), both_parts()));
  EXPECT_LT(missed.p_value, 1e-6);
  EXPECT_GT(missed.lag_one_correlation, 0.5);
}

// F(1, n) at t^2: the two-sided 5 % point of Student's t with 10 degrees of freedom is 2.228139.
TEST(FTest, IsTheSquareOfStudentsT) {
  frac::FitResult simple{}, full{};
  simple.free_parameters = 2;
  full.free_parameters = 3;
  simple.residuals = full.residuals = 13;
  full.cost = 10;
  simple.cost = 10 + 2.2281388519649385 * 2.2281388519649385;
  EXPECT_NEAR(frac::f_test(simple, full).p_value, 0.05, 1e-10);
  EXPECT_NEAR(frac::f_test(simple, full).statistic, 4.96460274, 1e-7);
  EXPECT_THROW((void)frac::f_test(full, simple), std::invalid_argument);
}

// Predicted blocks of a right structure scatter like the noise; of 60 points with 3 parameters by some per cent more.
TEST(CrossValidation, PredictsAtTheNoiseLevelWithTheRightStructure) {
  const auto data = noisy_response("K/(T s^a + 1)", {2, 0.5, 0.6}, 0.01, 3);
  const double right = frac::cross_validation(data, frac::Structure("K/(T s^a + 1)"), both_parts(), 6);
  const double wrong = frac::cross_validation(data, frac::Structure("K/(T s + 1)"), both_parts(), 6);
  EXPECT_NEAR(right, 0.01, 0.003);
  EXPECT_GT(wrong, 0.1);
  EXPECT_THROW((void)frac::cross_validation(data, frac::Structure("K"), both_parts(), 1), std::invalid_argument);
}

TEST(Growth, StopsAtTheStructureOfTheData) {
  const auto one = noisy_response("1/(b0 + b1 s^a1)", {0.5, 0.3, 0.7}, 0.01, 5);
  EXPECT_EQ(frac::grow(one, frac::GrowthFamily::denominator, both_parts()).chosen, 0u);
  const auto two = noisy_response("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", {}, 0.01, 6);
  const frac::Growth growth = frac::grow(two, frac::GrowthFamily::denominator, both_parts());
  EXPECT_EQ(growth.chosen, 1u);
  EXPECT_EQ(growth.fits[growth.chosen].model, "1/(b0 + b1 s^a1 + b2 s^a2)");
  const auto arcs =
      noisy_response("R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)", {1, 2, 0.05, 0.9, 3, 3, 0.7}, 0.003, 7, 120);
  EXPECT_EQ(frac::grow(arcs, frac::GrowthFamily::arcs, both_parts()).chosen, 1u);
}

}  // namespace
