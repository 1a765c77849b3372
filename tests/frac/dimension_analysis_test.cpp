// SPDX-License-Identifier: BSD-3-Clause
#include "formula/dimension_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>

namespace {

using frac::Structure;
using frac::detail::ParameterDimension;

struct DimensionCase {
  const char* formula;
  std::vector<double> parameters;
  std::vector<ParameterDimension> expected;
};

class DimensionAnalysis : public testing::TestWithParam<DimensionCase> {};

// A linear system with entries of order 1 and a handful of unknowns: 1e-12 is a thousand roundings.
TEST_P(DimensionAnalysis, FindsTheUnits) {
  const auto& [formula, parameters, expected] = GetParam();
  const auto dimensions = frac::detail::parameter_dimensions(Structure(formula), parameters);
  ASSERT_EQ(dimensions.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(dimensions[i].value_exponent, expected[i].value_exponent, 1e-12) << formula << ", parameter " << i;
    EXPECT_NEAR(dimensions[i].frequency_exponent, expected[i].frequency_exponent, 1e-12)
        << formula << ", parameter " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cases, DimensionAnalysis,
    testing::Values(
        DimensionCase{"K/(T s^a + 1)", {1, 1, 0.7}, {{1, 0}, {0, -0.7}, {0, 0}}},
        DimensionCase{"R0 + R1/(1 + R1 Q1 s^n1)", {1, 1, 1, 0.8}, {{1, 0}, {1, 0}, {-1, -0.8}, {0, 0}}},
        DimensionCase{
            "1/(b2 s^a2 + b1 s^a1 + b0)", {1, 2.2, 1, 0.9, 1}, {{-1, -2.2}, {0, 0}, {-1, -0.9}, {0, 0}, {-1, 0}}},
        DimensionCase{"K exp(-L s)/(T s + 1)", {1, 1, 1}, {{1, 0}, {0, -1}, {0, -1}}},
        DimensionCase{"K/(1 + (T s)^a)^b", {1, 1, 0.6, 0.4}, {{1, 0}, {0, -1}, {0, 0}, {0, 0}}},
        DimensionCase{"R + W tanh(sqrt(tau s))/sqrt(tau s)", {1, 1, 1}, {{1, 0}, {1, 0}, {0, -1}}},
        DimensionCase{"W coth((tau s)^0.5) s^-0.5", {1, 1}, {{1, 0.5}, {0, -1}}},
        DimensionCase{"1/(M s^2) + d + c s^q", {1, 1, 1, 0.5}, {{-1, -2}, {1, 0}, {1, -0.5}, {0, 0}}},
        DimensionCase{"sqrt(A + B s)", {1, 1}, {{2, 0}, {2, -1}}},
        DimensionCase{"-(A s - B)^2", {1, 1}, {{0.5, -1}, {0.5, 0}}},
        // Where units are left open the smallest exponents are taken, so a product shares alike.
        DimensionCase{"A B s", {1, 1}, {{0.5, -0.5}, {0.5, -0.5}}},
        // k - a w = 1 and k - a w = -a of least k^2 + w^2: (k, w) is a multiple of (1, -a), with 1 + a^2 = 1.36.
        DimensionCase{"K (s/w0)^a", {1, 1, 0.6}, {{1 / 1.36, -0.6 / 1.36}, {-0.6 / 1.36, 0.36 / 1.36}, {0, 0}}}));

// Numbers alone fix units that cannot be met; the rest is still found, here exactly: K has the unit of the value
// divided by that of the sum, for which the mean of [omega]^0.5 and 1 is taken.
TEST(DimensionAnalysis, IgnoresWhatCannotBeMet) {
  const auto dimensions = frac::detail::parameter_dimensions(Structure("K/(s^0.5 + 1)"), std::vector<double>{1});
  ASSERT_EQ(dimensions.size(), 1u);
  EXPECT_NEAR(dimensions[0].value_exponent, 1, 1e-12);
  EXPECT_NEAR(dimensions[0].frequency_exponent, 0.25, 1e-12);
  EXPECT_TRUE(frac::detail::parameter_dimensions(Structure("s^0.5 + 1"), {}).empty());
}

// What units mean: G at scaled parameters and frequency is the scaled G.
TEST(DimensionAnalysis, UnitsScaleTheModel) {
  const Structure structure(
      "R0 + R1/(1 + R1 C1 s) + 1/(C2 s + 1/(R2 + W/((tau s)^0.5 tanh((tau s)^0.5)))) + 1/(Q s^n)");
  const std::vector<double> parameters{0.3, 1.2, 0.4, 2, 0.5, 0.7, 1.1, 0.9, 0.65};
  const auto dimensions = frac::detail::parameter_dimensions(structure, parameters);
  const double value_scale = 37;
  const double frequency_scale = 0.02;
  std::vector<double> scaled = parameters;
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    scaled[i] *= std::pow(value_scale, dimensions[i].value_exponent) *
                 std::pow(frequency_scale, dimensions[i].frequency_exponent);
  }
  const std::complex<double> expected = value_scale * structure.response(parameters, 1.7);
  // Exponents to 1e-12 and a few dozen roundings.
  EXPECT_LT(std::abs(structure.response(scaled, 1.7 * frequency_scale) - expected), 1e-11 * std::abs(expected));
}

}  // namespace
