// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/zero_pole_gain.hpp"

#include <gtest/gtest.h>

#include "support/relative_error.hpp"

namespace {

using support::relative_error;
constexpr double eps = 2.2e-16;

TEST(ZeroPoleGain, IsTheRatioOfItsFactors) {
  const frac::ZeroPoleGain system{.zeros = {-1}, .poles = {-10, -3}, .gain = 5, .integer_order = 2};
  const std::complex<double> s(0, 2);
  // Five factors, each rounded a few times.
  EXPECT_LT(relative_error(system.response(2), 5.0 * s * s * (s + 1.0) / ((s + 10.0) * (s + 3.0))), 20 * eps);
}

TEST(ZeroPoleGain, WholeOrderAloneIsExact) {
  const frac::ZeroPoleGain double_integrator{.zeros = {}, .poles = {}, .gain = 3, .integer_order = -2};
  EXPECT_EQ(double_integrator.response(2), std::complex<double>(-0.75, 0));
  const frac::ZeroPoleGain derivative{.zeros = {}, .poles = {}, .gain = 1, .integer_order = 1};
  EXPECT_EQ(derivative.response(7), std::complex<double>(0, 7));
}

// prod (jw + 1)/(jw + 1) over many factors: the product of the zeros alone is 1e9^1000.
TEST(ZeroPoleGain, ManyFactorsDoNotOverflow) {
  const std::vector<double> roots(1000, -1e9);
  const frac::ZeroPoleGain unity{.zeros = roots, .poles = roots, .gain = 1, .integer_order = 0};
  // Each factor is 1 to a rounding or two.
  EXPECT_LT(relative_error(unity.response(1e9), 1), 1000 * 2 * eps);
}

}  // namespace
