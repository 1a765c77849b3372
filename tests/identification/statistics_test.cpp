// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

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
