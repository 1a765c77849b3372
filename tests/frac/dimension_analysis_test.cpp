// SPDX-License-Identifier: BSD-3-Clause
#include "formula/dimension_analysis.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "frac/parameter_units.hpp"

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

struct UnitCase {
  const char* formula;
  const char* value_unit;
  std::vector<std::string> expected;  // by hand: every term of a sum has the unit of its neighbours
};

class ParameterUnits : public testing::TestWithParam<UnitCase> {};

TEST_P(ParameterUnits, FollowFromTheFormula) {
  const auto& [formula, value_unit, expected] = GetParam();
  EXPECT_EQ(frac::parameter_units(Structure(formula), value_unit), expected) << formula;
}

INSTANTIATE_TEST_SUITE_P(
    Cases, ParameterUnits,
    testing::Values(UnitCase{"K/(T s^a + 1)", "m/N", {"m/N", "s^a", "1"}},
                    UnitCase{"R0 + R1/(1 + R1 Q1 s^n1)", "ohm", {"ohm", "ohm", "ohm^-1 s^n1", "1"}},
                    UnitCase{"R + W tanh(sqrt(tau s))/sqrt(tau s)", "mΩ", {"mΩ", "mΩ", "s"}},
                    // What stands behind a slash would be divided by.
                    UnitCase{"1/(b2 s^a2 + b1 s^a1 + b0)", "m/N", {"s^a2 N/m", "1", "s^a1 N/m", "1", "N/m"}},
                    UnitCase{"K/(1 + (T s)^a)^b", "1", {"1", "s", "1", "1"}},
                    UnitCase{"W s^-n + L s + E/s", "ohm", {"ohm s^-n", "1", "ohm s", "ohm s^-1"}},
                    UnitCase{"K s^(1 - n)", "MPa", {"MPa s^(1 - n)", "1"}},
                    UnitCase{"K w^2/(s^2 + 2 z w s + w^2)", "m/N", {"m/N", "rad/s", "1"}},
                    UnitCase{"R/(1 + (R Q)^(1/n) s)", "ohm", {"ohm", "ohm^-1 s^n", "1"}},
                    UnitCase{"R/(1 + (R C s)^2)", "ohm cm2", {"ohm cm2", "(ohm cm2)^-1 s"}},
                    // A unit that is not known leaves what is free of it, and a number may carry the one that is.
                    UnitCase{"K exp(-L s)/(T s + 1)", "", {"", "s", "s"}},
                    UnitCase{"50 exp(-L s)/(T s + 1)", "m/N", {"s", "s"}},
                    UnitCase{"K + 50/(T s + 1)", "m/N", {"", ""}}, UnitCase{"2 K/(T s + 1)", "m/N", {"m/N", "s"}},
                    // A choice, numbers of unlike units, and a power that is no straight line over the order.
                    UnitCase{"K/(T s + U)", "m/N", {"", "", ""}}, UnitCase{"K (s/w)^a", "m/N", {"", "", "1"}},
                    UnitCase{"K/(T s + 1) + 1/(s + 2)", "m/N", {"", ""}},
                    UnitCase{"K/(1 + T^n s)", "m/N", {"m/N", "", "1"}}));

// A formula that the units fit keeps its value when all of them change: with the unit of time 2 and that of the value
// 3 times as small, each parameter is to be multiplied as its unit says.  A few roundings of a response of order 1.
TEST(ParameterUnits, KeepTheValueWhenUnitsChange) {
  const Structure structure("R0 + R1/(1 + R1 Q1 s^n1) + W tanh((tau s)^0.5)/(tau s)^0.5 + L s");
  EXPECT_EQ(frac::parameter_units(structure, "ohm"),
            (std::vector<std::string>{"ohm", "ohm", "ohm^-1 s^n1", "1", "ohm", "s", "ohm s"}));
  const double time = 2, ohm = 3, n1 = 0.8;
  const std::vector<double> plain{0.3, 1.2, 0.5, n1, 0.7, 4, 0.1},
      changed{0.3 * ohm, 1.2 * ohm, 0.5 / ohm * std::pow(time, n1), n1, 0.7 * ohm, 4 * time, 0.1 * ohm * time};
  for (const double omega : {0.01, 1.0, 30.0})
    EXPECT_LT(std::abs(structure.response(changed, omega / time) - ohm * structure.response(plain, omega)), 1e-13);
}

}  // namespace
