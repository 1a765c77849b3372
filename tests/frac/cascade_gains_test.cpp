// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/cascade_gains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;

// Block by block: the speed controller K2 (1 + 1/(T s)) of the speed error K1 (r - y) - s y.
TEST(CascadeGains, AreThePidOfTheTwoControllers) {
  support::Random random(36);
  for (int i = 0; i < 100; ++i) {
    frac::CascadeGains cascade{random.log_uniform(0.1, 100), random.log_uniform(0.1, 100)};
    if (i % 4 != 0) cascade.integral_time = random.log_uniform(0.01, 10);
    const frac::FractionalPidGains pid = frac::pid_of(cascade);
    const double weight = frac::setpoint_weight_of(cascade);
    for (const double omega : {0.01, 1.0, 100.0}) {
      const Complex s(0, omega);
      const Complex speed = cascade.speed_gain * (1.0 + 1.0 / (cascade.integral_time * s));
      const Complex of_set_point = speed * cascade.position_gain, of_position = speed * (cascade.position_gain + s);
      // A handful of roundings of sums of the size of their parts.
      EXPECT_LT(std::abs(pid.kp * weight + pid.ki / s - of_set_point), 1e-14 * std::abs(of_set_point));
      EXPECT_LT(std::abs(pid.kp + pid.ki / s + pid.kd * s - of_position), 1e-14 * (pid.kp + std::abs(of_position)));
    }
  }
}

TEST(CascadeGains, AreFoundInAPid) {
  support::Random random(37);
  for (int i = 0; i < 100; ++i) {
    // Roots a factor of 2 apart lose no more than a digit.
    const double slower = random.log_uniform(0.1, 100);
    frac::CascadeGains cascade{slower * random.uniform(2, 100), random.log_uniform(0.1, 100)};
    if (i % 4 != 0) cascade.integral_time = 1 / slower;
    const auto found = frac::cascade_of(frac::pid_of(cascade));
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->position_gain / cascade.position_gain, 1, 1e-14);
    EXPECT_EQ(found->speed_gain, cascade.speed_gain);
    if (i % 4 == 0)
      EXPECT_TRUE(std::isinf(found->integral_time));
    else
      EXPECT_NEAR(found->integral_time / cascade.integral_time, 1, 1e-13);
  }
}

TEST(CascadeGains, AreNoneWhereThereIsNoCascade) {
  EXPECT_FALSE(frac::cascade_of({.kp = 1, .ki = 1}));                          // no derivative
  EXPECT_FALSE(frac::cascade_of({.kp = 1, .ki = 1, .kd = 1}));                 // complex zeros
  EXPECT_FALSE(frac::cascade_of({.kp = 3, .ki = 1, .kd = 1, .lambda = 0.9}));  // fractional
  EXPECT_FALSE(frac::cascade_of({.kp = 3, .ki = 1, .kd = 1, .mu = 0.9}));
  EXPECT_FALSE(frac::cascade_of({.kp = 3, .ki = -1, .kd = 1}));  // T below 0
  EXPECT_FALSE(frac::cascade_of({.kp = -3, .ki = 1, .kd = 1}));  // K1 below 0
  EXPECT_TRUE(frac::cascade_of({.kp = -3, .ki = -1, .kd = -1}));
}

}  // namespace
