// SPDX-License-Identifier: BSD-3-Clause
// Data that break naive fits: each gives the right answer or a sentence that says why there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::Component;
using frac::FitOptions;
using frac::FitResult;
using frac::FrequencyResponseData;
using frac::ParameterEstimate;
using frac::Structure;
using support::log_grid;

FrequencyResponseData sampled(const char* formula, const std::vector<double>& parameters,
                              const std::vector<double>& omega, double noise = 0, std::uint64_t seed = 1) {
  const Structure structure(formula);
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, 1);
  std::vector<std::complex<double>> value;
  for (const double each : omega) {
    const std::complex<double> exact = structure.response(parameters, each);
    const double real = normal(generator), imaginary = normal(generator);
    value.push_back(exact + noise * std::abs(exact) * std::complex<double>(real, imaginary));
  }
  return {omega, value};
}

FitOptions both() {
  FitOptions options;
  options.component = Component::both;
  return options;
}

FitOptions imaginary() {
  FitOptions options;
  options.component = Component::imaginary;
  return options;
}

const ParameterEstimate& of(const FitResult& result, const std::string& name) {
  return *std::find_if(result.parameters.begin(), result.parameters.end(),
                       [&](const ParameterEstimate& estimate) { return estimate.name == name; });
}

/// Five standard errors: missed once in two million.
void expect_recovered(const FitResult& result, const std::string& name, double truth) {
  EXPECT_NEAR(of(result, name).value, truth, 5 * of(result, name).standard_error) << name << ": " << result.message;
  EXPECT_TRUE(of(result, name).identified) << name << ": " << result.message;
}

const char* const furnace = "1/(b2 s^a2 + b1 s^a1 + b0)";
const std::vector<double> furnace_truth{0.8, 2.2, 0.5, 0.9, 1};

TEST(HardCases, TwentySixDecadesOfFrequency) {
  const auto data = sampled("K/(T s^a + 1)", {2, 0.5, 0.6}, log_grid(1e-13, 1e13, 200), 0.01);
  for (const Component component : {Component::both, Component::imaginary}) {
    FitOptions options;
    options.component = component;
    const FitResult result = frac::fit(data, Structure("K/(T s^a + 1)"), options);
    expect_recovered(result, "K", 2);
    expect_recovered(result, "T", 0.5);
    expect_recovered(result, "a", 0.6);
  }
}

// Both parts of five points: ten residuals.  The imaginary parts alone: as many as parameters.  The condition of the
// scaled problem is below 1e6, so parameters come back to 1e-16 sqrt(1e6) and what the stopping rules leave.
TEST(HardCases, FivePointsForFiveParameters) {
  const auto data = sampled(furnace, furnace_truth, {0.1, 0.5, 1, 2, 10});
  for (const Component component : {Component::both, Component::imaginary}) {
    FitOptions options;
    options.component = component;
    const FitResult result = frac::fit(data, Structure(furnace), options);
    for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(result.parameters[i].value, furnace_truth[i], 1e-8);
    const bool says_so = result.message.find("no more than the parameters") != std::string::npos;
    EXPECT_EQ(says_so, component == Component::imaginary) << result.message;
    EXPECT_EQ(std::isnan(of(result, "b0").standard_error), component == Component::imaginary);
  }
  // One less than parameters is refused.
  EXPECT_THROW((void)frac::fit(sampled(furnace, furnace_truth, {0.1, 1, 2, 10}), Structure(furnace), imaginary()),
               std::invalid_argument);
}

TEST(HardCases, AllValuesEqual) {
  const FrequencyResponseData data(log_grid(1e-1, 1e1, 21), std::vector<std::complex<double>>(21, 2.0));
  const FitResult lag = frac::fit(data, Structure("K/(T s^a + 1)"), both());
  // T = 0 with any order, or order 0 with any T: exact fits without end.
  EXPECT_FALSE(of(lag, "T").identified);
  const auto fitted = frac::fitted_response(lag, frac::ExactRealisation{}, {1.0});
  EXPECT_NEAR(std::abs(fitted[0] - 2.0), 0, 1e-12);
  const auto ranked = frac::identify(data, frac::model_library(), {}, both());
  EXPECT_EQ(ranked.ranking[ranked.chosen].name, "gain");
  EXPECT_EQ(ranked.verdict, frac::Verdict::fractional_not_supported);
  const FitResult nothing = frac::fit(data, Structure("K/(T s^a + 1)"), imaginary());
  EXPECT_NE(nothing.message.find("imaginary part of the data is 0 everywhere"), std::string::npos) << nothing.message;
}

TEST(HardCases, ExactlyAPowerLaw) {
  const auto data = sampled("K s^a", {3, 0.5}, log_grid(1e-1, 1e1, 21));
  const FitResult result = frac::fit(data, Structure("K s^a"), both());
  EXPECT_NEAR(of(result, "a").value, 0.5, 1e-13);
  EXPECT_TRUE(result.outliers.empty());
  const auto ranked = frac::identify(data, frac::model_library(), {}, both());
  EXPECT_EQ(ranked.ranking[ranked.chosen].name, "power-law");
  EXPECT_EQ(ranked.verdict, frac::Verdict::fractional_supported);
}

// -1/omega + omega/2 crosses 0 at sqrt 2; weighing by |Im| there would blow up.
TEST(HardCases, ImaginaryPartChangesItsSign) {
  const auto data = sampled("1/(C s) + R + L s", {1, 0.5, 0.5}, log_grid(1e-2, 1e2, 80), 0.01);
  const FitResult result = frac::fit(data, Structure("1/(C s) + R + L s"), imaginary());
  expect_recovered(result, "C", 1);
  expect_recovered(result, "L", 0.5);
  EXPECT_TRUE(of(result, "R").from_other_component);
}

// Time constants 1 s and 3 s behind orders of 0.8: the arcs merge into one, and only their sum is seen.
TEST(HardCases, TwoArcsAFactorThreeApartAreNotIdentified) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto data = sampled("1 + 10/(1 + s^n) + 10/(1 + (3 s)^n)", {0.8}, log_grid(1e-3, 1e3, 80), 0.01, seed);
    const FitResult result = frac::fit(data, Structure("R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)"), both());
    for (const char* name : {"R1", "R2"}) EXPECT_FALSE(of(result, name).identified) << name << ", seed " << seed;
    EXPECT_TRUE(of(result, "R0").identified);
    // 80 points of 1 % noise know the sum to some tenths of a per cent.
    EXPECT_NEAR(of(result, "R1").value + of(result, "R2").value, 20, 0.3);
  }
}

TEST(HardCases, NegativeResistances) {
  const char* const formula = "R0 + R1/(1 + (T s)^n)";
  const auto data = sampled(formula, {-3, -5, 0.2, 0.8}, log_grid(1e-3, 1e3, 80), 0.01);
  const FitResult free = frac::fit(data, Structure(formula), both());
  expect_recovered(free, "R0", -3);
  expect_recovered(free, "R1", -5);
  expect_recovered(free, "n", 0.8);
  // A limit that was given is no default to speak of.
  FitOptions options = both();
  options.constraints = {{"R0", {}, 0.0, {}, {}}, {"R1", {}, 0.0, {}, {}}};
  const FitResult held = frac::fit(data, Structure(formula), options);
  EXPECT_GE(of(held, "R0").value, 0);
  EXPECT_EQ(of(held, "R0").lower_limit, 0);
  EXPECT_TRUE(held.advice.empty()) << held.message;
}

// The true order is the bound: about half of all noise puts the estimate on it, where it has no interval and must not
// spoil those of the others.
TEST(HardCases, OrderAtItsBound) {
  int on_bound = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto data = sampled("1 + 5/(1 + 0.2 s)", {}, log_grid(1e-3, 1e3, 80), 0.005, seed);
    FitOptions options = both();
    options.constraints = {{"n", {}, 0, 1, {}}};
    const FitResult result = frac::fit(data, Structure("R0 + R1/(1 + (T s)^n)"), options);
    expect_recovered(result, "R0", 1);
    expect_recovered(result, "R1", 5);
    expect_recovered(result, "T", 0.2);
    EXPECT_LE(of(result, "n").value, 1);
    if (!of(result, "n").at_bound) continue;
    ++on_bound;
    EXPECT_TRUE(std::isnan(of(result, "n").standard_error));
    EXPECT_NE(result.message.find("At a bound: n."), std::string::npos) << result.message;
  }
  // Binomial, 20 draws of a half: outside 3 to 17 once in 2500.
  EXPECT_GE(on_bound, 3);
  EXPECT_LE(on_bound, 17);
}

// Three values at each frequency, with the pooled spread as weight: a cost per residual of 1 within four of its
// standard deviations, sqrt(2/480).
TEST(HardCases, DuplicatedFrequencies) {
  std::vector<double> omega;
  for (const double each : log_grid(1e-2, 1e2, 80)) omega.insert(omega.end(), 3, each);
  const auto data = sampled(furnace, furnace_truth, omega, 0.01);
  FitOptions options = both();
  for (const frac::Weight weight : {frac::Weight::relative, frac::Weight::smoothed_relative, frac::Weight::repeats}) {
    options.weight = weight;
    const FitResult result = frac::fit(data, Structure(furnace), options);
    const char* const names[] = {"b2", "a2", "b1", "a1", "b0"};
    for (std::size_t i = 0; i < 5; ++i) expect_recovered(result, names[i], furnace_truth[i]);
    if (weight == frac::Weight::repeats) {
      EXPECT_NEAR(result.cost / 480, 1, 4 * std::sqrt(2.0 / 480));
    }
  }
}

TEST(HardCases, GainsOfTenToThePowerOfEighteen) {
  for (const double gain : {1e-18, 1e18}) {
    const auto unit = sampled(furnace, furnace_truth, log_grid(1e-2, 1e2, 80), 0.01);
    std::vector<std::complex<double>> value = unit.value();
    for (auto& each : value) each *= gain;
    for (const frac::Weight weight : {frac::Weight::relative, frac::Weight::absolute}) {
      FitOptions options = both();
      options.weight = weight;
      const FitResult result = frac::fit({unit.omega(), value}, Structure(furnace), options);
      EXPECT_NEAR(of(result, "b0").value * gain, 1, 0.05) << result.message;
      EXPECT_NEAR(of(result, "a2").value, 2.2, 0.05);
      EXPECT_TRUE(of(result, "b2").identified);
    }
  }
}

TEST(HardCases, UnorderedInputIsNamed) {
  try {
    const FrequencyResponseData data({1, 3, 2}, {{1, 0}, {1, 0}, {1, 0}});
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("2"), std::string::npos) << error.what();
  }
}

}  // namespace
