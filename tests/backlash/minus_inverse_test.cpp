// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/minus_inverse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>

#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::minus_inverse;
using Complex = std::complex<double>;

constexpr double epsilon = std::numeric_limits<double>::epsilon();

TEST(MinusInverse, IsItsOwnInverse) {
  support::Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Complex n = std::polar(random.log_uniform(1e-9, 1e3), random.uniform(-3.2, 3.2));
    const double uncertainty = std::abs(n) * random.log_uniform(1e-12, 1);
    const auto once = minus_inverse(n, uncertainty).value();
    // The product of both is -1, but for a few roundings of a complex quotient.
    EXPECT_LT(std::abs(once.value * n + 1.0), 4 * epsilon);
    const auto twice = minus_inverse(once.value, once.uncertainty).value();
    EXPECT_LT(std::abs(twice.value - n), 8 * epsilon * std::abs(n));
    EXPECT_NEAR(twice.uncertainty, uncertainty, 16 * epsilon * uncertainty);
  }
}

// A disc of radius r about N goes to a disc, whose radius is r/|N|^2 but for terms of order r/|N|.
TEST(MinusInverse, CarriesADiscOfUncertaintyOver) {
  const Complex n(3e-3, -1e-3);
  const double radius = 1e-6 * std::abs(n);
  const auto centre = minus_inverse(n, radius).value();
  for (double angle = 0; angle < 6.2; angle += 0.5) {
    const auto moved = minus_inverse(n + std::polar(radius, angle), 0).value();
    EXPECT_NEAR(std::abs(moved.value - centre.value), centre.uncertainty, 3e-6 * centre.uncertainty);
  }
}

TEST(MinusInverse, OfAPointIsThatOfItsValue) {
  backlash::DescribingFunctionPoint point{};
  point.value = {-0.5, 0};
  point.uncertainty = 1e-3;
  const auto inverse = minus_inverse(point).value();
  EXPECT_DOUBLE_EQ(inverse.value.real(), 2);
  EXPECT_DOUBLE_EQ(inverse.uncertainty, 4e-3);  // dN/N^2
}

TEST(MinusInverse, OfZeroThereIsNone) {
  EXPECT_FALSE(minus_inverse(Complex(0, 0), 0));
  EXPECT_FALSE(minus_inverse(Complex(-0.0, 0), 1e-3));
  // 1/denormal overflows.
  EXPECT_FALSE(minus_inverse(Complex(std::numeric_limits<double>::denorm_min(), 0), 0));
  // What is no number does not turn into a point that is missing for a good reason.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto of_nan = minus_inverse(Complex(nan, nan), nan);
  ASSERT_TRUE(of_nan);
  EXPECT_TRUE(std::isnan(of_nan->value.real()));
}

TEST(MinusInverse, OfDataLeavesZerosOutAndNamesThem) {
  const frac::FrequencyResponseData data({1, 2, 4}, {{0.5, 0}, {0, 0}, {0, 0.25}}, {0.01, 0.02, 0.03},
                                         frac::FrequencyUnit::hertz);
  const auto inverse = minus_inverse(data);
  EXPECT_EQ(inverse.left_out, std::vector<double>{2});
  ASSERT_EQ(inverse.data.size(), 2U);
  EXPECT_EQ(inverse.data.omega(), (std::vector<double>{1, 4}));
  // -1/0.5 and -1/(0.25 j) = 4 j; sigma over |N|^2.  All of these are exact in binary but for 0.01 and 0.03.
  EXPECT_EQ(inverse.data.value()[0], Complex(-2, 0));
  EXPECT_EQ(inverse.data.value()[1], Complex(0, 4));
  EXPECT_DOUBLE_EQ(inverse.data.sigma()[0], 0.04);
  EXPECT_DOUBLE_EQ(inverse.data.sigma()[1], 0.48);
  EXPECT_EQ(inverse.data.frequency_unit(), frac::FrequencyUnit::hertz);
  support::expect_invalid_argument([] { static_cast<void>(minus_inverse(frac::FrequencyResponseData({1}, {0}))); },
                                   {"0 at each of its 1 points"});
}

TEST(Quantity, IsSpelledAsOnTheCommandLine) {
  for (const auto quantity : backlash::quantities())
    EXPECT_EQ(backlash::quantity_from_string(backlash::to_string(quantity)), quantity);
  EXPECT_EQ(backlash::to_string(backlash::Quantity::minus_inverse), "minus-inverse");
  support::expect_invalid_argument([] { static_cast<void>(backlash::quantity_from_string("1/n")); },
                                   {"1/n", "n, minus-inverse"});
}

}  // namespace
