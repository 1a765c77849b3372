// SPDX-License-Identifier: BSD-3-Clause
#include "frac/laplace_value.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

namespace {

using Complex = std::complex<double>;
constexpr double eps = std::numeric_limits<double>::epsilon();

frac::FractionalTransferFunction model_of(const char* formula) {
  return frac::FractionalTransferFunction::parse(formula);
}

// Powers e^{q ln s} err by q |ln s| roundings, below ten here.
TEST(LaplaceValue, IsTheRatioOfPowersInTheWholePlane) {
  const auto model = model_of("exp(-0.3 s) (2 s^0.5 + 1)/(s^1.7 + 4)");
  for (const Complex s : {Complex(1, 2), Complex(-3, 0.5), Complex(-0.2, -4), Complex(0, 7)}) {
    const Complex expected = std::exp(-0.3 * s) * (2.0 * std::sqrt(s) + 1.0) / (std::exp(1.7 * std::log(s)) + 4.0);
    EXPECT_LT(std::abs(laplace_value(model, s) / expected - 1.0), 30 * eps) << s;
  }
}

TEST(LaplaceValue, TakesTheSideOfTheCutThatTheSignOfTheImaginaryPartTells) {
  const auto root = model_of("s^0.5");
  EXPECT_LT(std::abs(laplace_value(root, {-9, 0.0}) - Complex(0, 3)), 20 * eps);
  EXPECT_LT(std::abs(laplace_value(root, {-9, -0.0}) - Complex(0, -3)), 20 * eps);
}

TEST(LaplaceValue, HasItsLimitAtTheOrigin) {
  EXPECT_EQ(laplace_value(model_of("(s^0.5 + 6)/(s + 2)"), 0), 3.0);
  EXPECT_EQ(laplace_value(model_of("s^0.5/(s + 2)"), 0), 0.0);
  EXPECT_TRUE(std::isinf(laplace_value(model_of("1/(s^0.5 (s + 2))"), 0).real()));
}

// s^40 at 1e300 exceeds a double by far, the ratio does not.
TEST(LaplaceValue, DoesNotOverflowOnTheWay) {
  EXPECT_NEAR(laplace_value(model_of("(2 s^20 + 1)/(s^20 + 3)"), {1e300, 0}).real(), 2, 1e-11);
}

}  // namespace
