// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/power_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

// Rounding of logarithms of size 10 over spans of a few e-folds: some units of 1e-15.
constexpr double rounding = 1e-13;

TEST(PowerLaw, PassesThroughExactData) {
  std::vector<double> x, y;
  for (int i = 0; i < 9; ++i) {
    x.push_back(0.01 * std::pow(1.7, i));
    y.push_back(3.5 * std::pow(x.back(), -0.62));
  }
  const frac::PowerLaw law = frac::fit_power_law(x, y);
  EXPECT_NEAR(law.exponent, -0.62, rounding);
  EXPECT_NEAR(law.coefficient, 3.5, 3.5 * 10 * rounding);
  EXPECT_NEAR(law.r_squared, 1, rounding);
  EXPECT_NEAR(law(2.0), 3.5 * std::pow(2.0, -0.62), 100 * rounding);
}

// ln x = 0, 1, 2 and ln y = 0, 1.1, 1.9: slope .95, residuals -.05, .1, -.05, so s^2 = .015 with one degree of freedom,
// whose t is tan(.475 pi) = 12.7062047.
TEST(PowerLaw, MatchesARegressionDoneByHand) {
  const std::vector<double> x = {1, std::exp(1.0), std::exp(2.0)};
  const std::vector<double> y = {1, std::exp(1.1), std::exp(1.9)};
  const frac::PowerLaw law = frac::fit_power_law(x, y);
  const double t = std::tan(0.475 * M_PI);
  const double slope_error = std::sqrt(0.015 / 2);
  const double log_coefficient_error = std::sqrt(0.015 * (1.0 / 3 + 0.5));
  EXPECT_NEAR(law.exponent, 0.95, rounding);
  EXPECT_NEAR(law.coefficient, std::exp(0.05), rounding);
  EXPECT_NEAR(law.exponent_standard_error, slope_error, rounding);
  EXPECT_NEAR(law.exponent_ci95_lower, 0.95 - t * slope_error, 1e-9);  // the quantile's own accuracy
  EXPECT_NEAR(law.exponent_ci95_upper, 0.95 + t * slope_error, 1e-9);
  EXPECT_NEAR(std::log(law.coefficient_ci95_upper), 0.05 + t * log_coefficient_error, 1e-9);
  EXPECT_NEAR(std::log(law.coefficient_ci95_lower), 0.05 - t * log_coefficient_error, 1e-9);
  EXPECT_NEAR(law.r_squared, 1 - 0.015 / 1.82, rounding);
  EXPECT_NEAR(law.rms_log_residual, std::sqrt(0.015), rounding);
}

// 4000 trials: the coverage of a 95 % interval scatters by sqrt(.95 .05/4000) = 0.34 %; four of these are allowed.
TEST(PowerLaw, IntervalsCoverTheTruthAtTheirLevel) {
  std::mt19937_64 generator(7);
  std::normal_distribution<double> noise(0, 0.1);
  int exponent_covered = 0, coefficient_covered = 0;
  constexpr int trials = 4000;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> x, y;
    for (int i = 0; i < 6; ++i) {
      x.push_back(5.0 * (i + 1));
      y.push_back(2 * std::sqrt(x.back()) * std::exp(noise(generator)));
    }
    const frac::PowerLaw law = frac::fit_power_law(x, y);
    exponent_covered += law.exponent_ci95_lower <= 0.5 && 0.5 <= law.exponent_ci95_upper;
    coefficient_covered += law.coefficient_ci95_lower <= 2 && 2 <= law.coefficient_ci95_upper;
  }
  EXPECT_NEAR(exponent_covered / double(trials), 0.95, 0.014);
  EXPECT_NEAR(coefficient_covered / double(trials), 0.95, 0.014);
}

TEST(PowerLaw, TwoPointsGiveNoInterval) {
  const frac::PowerLaw law = frac::fit_power_law(std::vector<double>{1, 4}, std::vector<double>{3, 6});
  EXPECT_NEAR(law.exponent, 0.5, rounding);
  EXPECT_TRUE(std::isnan(law.exponent_ci95_lower));
  EXPECT_TRUE(std::isnan(law.rms_log_residual));
}

std::string message(const std::vector<double>& x, const std::vector<double>& y) {
  try {
    (void)frac::fit_power_law(x, y);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no exception";
}

TEST(PowerLaw, RefusesWhatHasNoPowerLaw) {
  EXPECT_NE(message({1, 2}, {1}).find("2 x values but 1 y"), std::string::npos);
  EXPECT_NE(message({1}, {1}).find("at least 2"), std::string::npos);
  EXPECT_NE(message({1, -2}, {1, 1}).find("x[1] = -2"), std::string::npos);
  EXPECT_NE(message({1, 2}, {1, NAN}).find("y[1] = nan"), std::string::npos);
  EXPECT_NE(message({2, 2}, {1, 3}).find("all x are equal"), std::string::npos);
}

}  // namespace
