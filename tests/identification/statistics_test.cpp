// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "identification/statistics/information.hpp"

namespace {

// Student's density with four degrees of freedom is 3/8 (1 + x^2/4)^(-5/2).  The scale is searched on a grid of steps
// of 1e-3, which misses the least -2 ln L of 41 values by less than n times the square of that.
TEST(Statistics, MisfitUnderHeavyTailsIsTheLikelihoodOfStudentsDistribution) {
  std::vector<double> residual;
  for (int i = 0; i < 40; ++i) residual.push_back(0.1 * std::sin(1.7 * i * i));
  residual.push_back(2.5);
  double least = std::numeric_limits<double>::infinity(), square = 0;
  for (double log_scale = -6; log_scale < 1; log_scale += 1e-3) {
    double value = 0;
    for (const double r : residual) {
      const double x = r / std::exp(log_scale);
      value -= 2 * (std::log(0.375) - 2.5 * std::log(1 + x * x / 4) - log_scale);
    }
    least = std::min(least, value);
  }
  for (const double r : residual) square += r * r;
  const double n = static_cast<double>(residual.size());
  EXPECT_NEAR(frac::detail::heavy_tailed_misfit(residual), least - n * (1 + std::log(2 * std::numbers::pi)), 41e-6);
  // The one large residual is worth less than it costs under normal noise, and without it the tails are of no use.
  EXPECT_LT(frac::detail::heavy_tailed_misfit(residual), n * std::log(square / n));
  residual.pop_back();
  square -= 2.5 * 2.5;
  EXPECT_GT(frac::detail::heavy_tailed_misfit(residual), 40 * std::log(square / 40));
}

// Table of Student's t for a two-sided 5 %, to the digits printed in it.
TEST(StudentT, IsThatOfTheTables) {
  EXPECT_NEAR(frac::student_t_95(1), 12.706, 5e-4);
  EXPECT_NEAR(frac::student_t_95(5), 2.571, 5e-4);
  EXPECT_NEAR(frac::student_t_95(10), 2.228, 5e-4);
  EXPECT_NEAR(frac::student_t_95(120), 1.980, 5e-4);
  EXPECT_TRUE(std::isnan(frac::student_t_95(0)));
}

// n = 10, one parameter, cost 10: ln(cost/n) = 0, k = 2.
TEST(InformationCriteria, FollowTheirDefinitions) {
  const auto criteria = frac::information_criteria(10, 10, 1, 0);
  EXPECT_DOUBLE_EQ(criteria.aicc, 4 + 12.0 / 7);
  EXPECT_DOUBLE_EQ(criteria.bic, 2 * std::log(10.0));
  EXPECT_TRUE(std::isinf(frac::information_criteria(10, 3, 1, 0).aicc));
  // Two exact fits differ by their parameters alone.
  const auto small = frac::information_criteria(1e-31, 10, 1, 1e-28),
             large = frac::information_criteria(0, 10, 2, 1e-28);
  EXPECT_NEAR(large.aicc - small.aicc, (6 + 24.0 / 6) - (4 + 12.0 / 7), 1e-12);
}

}  // namespace
