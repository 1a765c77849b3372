// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/fractional_transfer_function.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frac/model/algebra.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::PowerTerm;
using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;
using Terms = std::vector<PowerTerm>;

constexpr double eps = 2.2e-16;

TEST(FractionalTransferFunction, KeepsTermsByFallingOrderAndAddsEqualOnes) {
  const FractionalTransferFunction system({{1, 0}, {2, 1.5}, {3, 0}}, {{1, 0.3}, {0, 7}, {1, 0.1 + 0.2}, {4, 2}}, 0.5);
  EXPECT_EQ(system.numerator(), (Terms{{2, 1.5}, {4, 0}}));
  EXPECT_EQ(system.denominator(), (Terms{{4, 2}, {2, 0.1 + 0.2}}));
  EXPECT_EQ(system.delay(), 0.5);
}

TEST(FractionalTransferFunction, ASingleDenominatorTermHasTheCoefficientOne) {
  const FractionalTransferFunction system({{3, 1}, {1, 0}}, {{2, 0.5}});
  EXPECT_EQ(system.numerator(), (Terms{{1.5, 1}, {0.5, 0}}));
  EXPECT_EQ(system.denominator(), (Terms{{1, 0.5}}));
}

TEST(FractionalTransferFunction, RefusesWhatIsNoTransferFunction) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([] { FractionalTransferFunction({}, {{1, 0}}); }, {"the numerator is zero"});
  expect_invalid_argument([] { FractionalTransferFunction({{1, 0}}, {{1, 1}, {-1, 1}}); }, {"the denominator is zero"});
  expect_invalid_argument([&] { FractionalTransferFunction({{nan, 0}}, {{1, 1}}); }, {"numerator[0] = nan s^0"});
  expect_invalid_argument(
      [&] {
        FractionalTransferFunction({{1, 0}}, {{1, 0}, {1, INFINITY}});
      },
      {"denominator[1] = 1 s^inf"});
  expect_invalid_argument([] { FractionalTransferFunction({{1, 0}}, {{1, 1}}, -0.1); }, {"delay = -0.1 s"});
  expect_invalid_argument([&] { FractionalTransferFunction({{1, 0}}, {{1, 1}}, nan); }, {"delay = nan"});
}

TEST(FractionalTransferFunction, ReducesFormulas) {
  const struct {
    const char* formula;
    Terms numerator;
    Terms denominator;
    double delay;
  } cases[] = {
      {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", {{1, 0}}, {{0.8, 2.2}, {0.5, 0.9}, {1, 0}}, 0},
      {"exp(-0.25 s) (2 s^0.5 + 1)/(s^1.5 + 1)", {{2, 0.5}, {1, 0}}, {{1, 1.5}, {1, 0}}, 0.25},
      {"(s + 1)^2/(s - 1)", {{1, 2}, {2, 1}, {1, 0}}, {{1, 1}, {-1, 0}}, 0},
      {"(s + 1)^-2", {{1, 0}}, {{1, 2}, {2, 1}, {1, 0}}, 0},
      {"2 + 1/(s + 1)", {{2, 1}, {3, 0}}, {{1, 1}, {1, 0}}, 0},
      {"1/(s + 1) + 1/(s + 2)", {{2, 1}, {3, 0}}, {{1, 2}, {3, 1}, {2, 0}}, 0},
      {"1/(s + 1) + 2/(s + 1)", {{3, 0}}, {{1, 1}, {1, 0}}, 0},
      {"2/s + 3/s^2", {{2, 1}, {3, 0}}, {{1, 2}}, 0},
      {"1/(4 s^2) + 3 + 2 s^0.5", {{2, 2.5}, {3, 2}, {0.25, 0}}, {{1, 2}}, 0},
      {"1/(s^2 + s) + 1/(s^3 + s)", {{1, 2}, {1, 1}, {2, 0}}, {{1, 4}, {1, 3}, {1, 2}, {1, 1}}, 0},
      {"(4 s)^0.5 - sqrt(s)", {{1, 0.5}}, {{1, 0}}, 0},
      {"(s/4)^0.5 (4/s)^1.5", {{4, -1}}, {{1, 0}}, 0},
      {"sqrt(s^1.5)", {{1, 0.75}}, {{1, 0}}, 0},
      {"(16/s^0.5)^0.25", {{2, -0.125}}, {{1, 0}}, 0},
      {"exp(-s)^2/exp(-0.5 s)", {{1, 0}}, {{1, 0}}, 1.5},
      {"exp(0)*tanh(0) + s", {{1, 1}}, {{1, 0}}, 0},
      {"s/(1/2)", {{2, 1}}, {{1, 0}}, 0},
  };
  for (const auto& each : cases) {
    const auto system = FractionalTransferFunction::parse(each.formula);
    EXPECT_EQ(system.numerator(), each.numerator) << each.formula << " -> " << system.formula();
    EXPECT_EQ(system.denominator(), each.denominator) << each.formula << " -> " << system.formula();
    EXPECT_EQ(system.delay(), each.delay) << each.formula;
  }
}

// 0.1 + 0.2 - 0.3 is 5.6e-17 in doubles: a term of that size would be a pole at -2e16 rad/s.  Formulas, terms and the
// algebra of models agree that it is nothing.
TEST(FractionalTransferFunction, WhatCancelsToRoundingIsNothing) {
  const FractionalTransferFunction expected({{1, 0}}, {{1, 0.5}, {1, 0}});
  EXPECT_EQ(FractionalTransferFunction::parse("1/(0.1 s + 0.2 s - 0.3 s + s^0.5 + 1)"), expected);
  EXPECT_EQ(FractionalTransferFunction({{1, 0}}, {{0.1, 1}, {0.2, 1}, {-0.3, 1}, {1, 0.5}, {1, 0}}), expected);
  const auto model = [](const char* formula) { return FractionalTransferFunction::parse(formula); };
  EXPECT_EQ(model("0.1 s + s^0.5 + 1") + model("0.2 s") - model("0.3 s"), model("s^0.5 + 1"));
}

TEST(FractionalTransferFunction, WritesFormulas) {
  const auto formula = [](const char* text) { return FractionalTransferFunction::parse(text).formula(); };
  EXPECT_EQ(formula("1/(0.8s^2.2+0.5s^0.9+1)"), "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  EXPECT_EQ(formula("exp(-0.2 s) (1 + 2 s^0.5)/(s^1.5 + 1)"), "exp(-0.2 s) (2 s^0.5 + 1)/(s^1.5 + 1)");
  EXPECT_EQ(formula("exp(-0.2 s)/(s + 1)"), "exp(-0.2 s)/(s + 1)");
  EXPECT_EQ(formula("-s + 3 s^-1.5 - 1"), "-s - 1 + 3 s^-1.5");
  EXPECT_EQ(formula("(s + 1)/s^0.5"), "(s + 1)/s^0.5");
  EXPECT_EQ(formula("5"), "5");
  EXPECT_EQ(formula("1e-30 s^1e-5"), "1e-30 s^1e-05");
}

// The reduced form and the structure it came from are two ways to the same value.
TEST(FractionalTransferFunction, RespondsLikeTheStructure) {
  const frac::Structure structure("exp(-L s) (R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + (tau s)^n2) + (s/w0)^2)/(s^0.3 + 2)");
  const std::vector<double> parameters{0.1, 0.5, 2, 0.7, 0.8, 3, 1.5, 0.6, 4};
  const auto system = frac::to_transfer_function(structure, parameters);
  EXPECT_EQ(system.delay(), 0.1);
  for (const double omega : log_grid(1e-4, 1e4, 50)) {
    // All coefficients are positive and all angles below 180 degrees: a few dozen roundings; the delay turns by 1000
    // rad.
    EXPECT_LT(relative_error(system.response(omega), structure.response(parameters, omega)), 1500 * eps) << omega;
  }
}

TEST(FractionalTransferFunction, FurnaceOnAGrid) {
  const auto furnace = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const frac::FrequencyResponseData data = furnace.response(std::vector<double>{1.190543709, 2});
  ASSERT_EQ(data.size(), 2u);
  // See Structure.FurnacePeak.
  EXPECT_NEAR(std::abs(data.value()[0]), 4.6208373031928, 4.6e-13);
  EXPECT_EQ(data.value()[1], furnace.response(2.0));
  const frac::OustaloupRealisation realisation{{1e-3, 1e3}, 5};
  EXPECT_EQ(furnace.response(std::vector<double>{2}, realisation).value()[0], furnace.response(2.0, realisation));
}

// |den| vanishes at the poles p of the furnace; at s = |p| e^{j phi} the powers are |p|^q e^{j q phi}.
TEST(FractionalTransferFunction, FurnaceDenominatorVanishesAtItsPoles) {
  const auto furnace = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const Complex pole(-0.10841680291289, 1.19699224474627);
  Complex denominator = 0;
  Complex slope = 0;
  for (const PowerTerm& term : furnace.denominator()) {
    denominator += term.coefficient * std::pow(pole, term.order);
    slope += term.coefficient * term.order * std::pow(pole, term.order - 1);
  }
  // Fourteen decimals of the pole.
  EXPECT_LT(std::abs(denominator), 1e-14 * std::abs(slope) + 4 * eps);
}

// 49 times the double nearest 1/49 is not 1.
TEST(FractionalTransferFunction, DividesByANumberAndDoesNotMultiplyByItsInverse) {
  for (int n = 1; n <= 100; ++n) {
    const std::string number = std::to_string(n);
    const auto model = FractionalTransferFunction::parse(number + " s/" + number + " + 1");
    EXPECT_EQ(model.numerator().front().coefficient, 1) << n;
  }
}

TEST(FractionalTransferFunction, NamesThePartThatDoesNotReduce) {
  const auto parse = [](const char* formula) { (void)FractionalTransferFunction::parse(formula); };
  expect_invalid_argument([&] { parse("1/(1 + s^0.5)^0.7"); }, {"\"(1 + s^0.5)^0.7\"", "power of a sum"});
  expect_invalid_argument([&] { parse("s + sqrt(1 + s)"); }, {"\"sqrt(1 + s)\"", "power of a sum"});
  expect_invalid_argument([&] { parse("1 + tanh(s)"); }, {"\"tanh(s)\"", "function of s"});
  expect_invalid_argument([&] { parse("coth(sqrt(s))"); }, {"\"coth(sqrt(s))\""});
  expect_invalid_argument([&] { parse("1 + exp(-s)"); }, {"different delays, 0 s and 1 s"});
  expect_invalid_argument([&] { parse("exp(-sqrt(s))"); }, {"\"exp(-sqrt(s))\"", "no multiple of s"});
  expect_invalid_argument([&] { parse("exp(1/s)"); }, {"no multiple of s"});
  expect_invalid_argument([&] { parse("exp(s)"); }, {"delay = -1 s"});
  expect_invalid_argument([&] { parse("(s^3)^0.5"); }, {"\"(s^3)^0.5\"", "below 2"});
  expect_invalid_argument([&] { parse("(-2 s)^0.5"); }, {"negative multiple"});
  expect_invalid_argument([&] { parse("1/(s - s)"); }, {"division by zero"});
  expect_invalid_argument([&] { parse("s - s"); }, {"the numerator is zero"});
  expect_invalid_argument([&] { parse("s + sqrt(-2)"); }, {"\"sqrt(-2)\"", "not finite"});
  expect_invalid_argument([&] { parse("K/(s + 1)"); }, {"parameter 'K'", "no value"});
  EXPECT_THROW(parse("1/(s +"), frac::FormulaError);
  expect_invalid_argument([&] { parse("(s^.1+s^.23+s^.37+s^.41+s^.53+s^.67+s^.79+s^.83+s^.97+1)^50"); },
                          {"10000 terms"});
}

TEST(FractionalTransferFunction, RefusesParametersOfTheWrongNumberOrSize) {
  const frac::Structure structure("K/(T s + 1)");
  expect_invalid_argument([&] { (void)frac::to_transfer_function(structure, std::vector<double>{1}); },
                          {"1 parameter values where 2"});
  expect_invalid_argument(
      [&] {
        (void)frac::to_transfer_function(structure, std::vector<double>{1, NAN});
      },
      {"T = nan"});
}

TEST(FractionalTransferFunction, RefusesFrequenciesItCannotRespondTo) {
  const auto system = FractionalTransferFunction::parse("1/(s^2 + 4)");
  expect_invalid_argument([&] { (void)system.response(0.0); }, {"omega = 0"});
  expect_invalid_argument([&] { (void)system.response(std::vector<double>{1, -1}); }, {"omega = -1"});
  expect_invalid_argument([&] { (void)system.response(std::vector<double>{2, 1}); }, {"increasing order"});
  expect_invalid_argument([&] { (void)system.response(std::vector<double>{}); }, {"no points"});
  expect_invalid_argument([&] { (void)system.response(std::vector<double>{1, 2}); }, {"value[1]", "not finite"});
  expect_invalid_argument(
      [&] {
        (void)system.response(40.0, frac::GrunwaldLetnikovRealisation{0.1, 0});
      },
      {"omega = 40"});
}

}  // namespace
