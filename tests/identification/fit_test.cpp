// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/fit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/approximation/oustaloup.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "support/relative_error.hpp"

namespace {

using frac::Component;
using frac::FitOptions;
using frac::FitResult;
using frac::FrequencyResponseData;
using frac::Structure;
using frac::Weight;
using support::log_grid;

constexpr double infinity = std::numeric_limits<double>::infinity();

FrequencyResponseData sample(const std::string& formula, const std::vector<double>& parameters,
                             const std::vector<double>& omega) {
  const Structure structure(formula);
  std::vector<std::complex<double>> value;
  for (const double w : omega) value.push_back(structure.response(parameters, w));
  return {omega, value};
}

double value_of(const FitResult& result, const std::string& name) {
  for (const auto& estimate : result.parameters) {
    if (estimate.name == name) return estimate.value;
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

const frac::ParameterEstimate& estimate_of(const FitResult& result, const std::string& name) {
  for (const auto& estimate : result.parameters) {
    if (estimate.name == name) return estimate;
  }
  throw std::logic_error("no parameter " + name);
}

struct Recovery {
  const char* formula;
  std::vector<double> parameters;
  double from, to;
  Component component;
  std::vector<frac::ParameterConstraint> constraints;
};

class RecoversExactData : public testing::TestWithParam<Recovery> {};

// Data exact to rounding 1e-16; the scaled Fisher condition of these problems is below 1e6, so parameters come back to
// 1e-16 sqrt(1e6) = 1e-13 at a true minimum and the solver's stopping rules leave at most a few decades more.
TEST_P(RecoversExactData, WithoutStartValues) {
  const Recovery& test = GetParam();
  const FrequencyResponseData data = sample(test.formula, test.parameters, log_grid(test.from, test.to, 120));
  FitOptions options;
  options.component = test.component;
  options.constraints = test.constraints;
  const FitResult result = frac::fit(data, Structure(test.formula), options);
  EXPECT_EQ(result.termination, frac::FitTermination::converged) << result.message;
  for (std::size_t i = 0; i < test.parameters.size(); ++i) {
    EXPECT_NEAR(result.parameters[i].value, test.parameters[i], 1e-8 * std::abs(test.parameters[i]))
        << result.parameters[i].name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fit, RecoversExactData,
    testing::Values(Recovery{"K s^a", {2.5, -1.3}, 1e-3, 1e3, Component::imaginary, {{"K", {}, -infinity, {}, {}}}},
                    Recovery{"K s^a", {-2.5, 0.666}, 5, 35, Component::imaginary, {{"K", {}, -infinity, {}, {}}}},
                    Recovery{"K/(T s^a + 1)", {0.8, 0.4, 0.7}, 1e-2, 1e3, Component::both, {}},
                    Recovery{"K/(T s^a + 1)", {0.8, 0.4, 1.7}, 1e-2, 1e2, Component::imaginary, {}},
                    Recovery{"1/(b2 s^a2 + b1 s^a1 + b0)",
                             {0.8, 2.2, 0.5, 0.9, 1},
                             1e-2,
                             1e2,
                             Component::both,
                             {{"a1", {}, 0, 1.5, {}}}},
                    Recovery{"1/(b2 s^a2 + b1 s^a1 + b0)",
                             {14994, 1.31, 6009.5, 0.97, 1.69},
                             1e-4,
                             1e1,
                             Component::both,
                             {{"a1", {}, 0, 1.1, {}}}},
                    Recovery{"1/(b2 s^a2 + b1 s^a1 + b0)",
                             {0.7943, 2.5708, 5.2385, 0.8372, 1.5560},
                             1e-3,
                             1e2,
                             Component::both,
                             {{"a1", {}, 0, 1.5, {}}}},
                    Recovery{"K/(1 + (T s)^a)^b",
                             {3, 0.02, 0.8, 0.45},
                             1e-2,
                             1e5,
                             Component::both,
                             {{"a", {}, 0, 1, {}}, {"b", {}, 0, 1, {}}}},
                    Recovery{"K exp(-L s)/(T s^a + 1)", {2, 0.5, 3, 0.8}, 1e-2, 1e1, Component::both, {}},
                    Recovery{"K/(T s^a + 1)", {0.8, 0.4, 0.7}, 1e-2, 1e3, Component::magnitude, {{"a", {}, 0, 2, {}}}},
                    Recovery{"1/(T s^a + 1)", {0.4, 0.7}, 1e-2, 1e3, Component::phase, {{"a", {}, 0, 2, {}}}},
                    Recovery{"R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)",
                             {0.01, 0.02, 3, 0.8, 0.03, 900, 0.9},
                             1e-3,
                             1e5,
                             Component::real,
                             {{"n1", {}, 0, 0.85, {}}, {"n2", {}, 0.86, 1, {}}}}));

// Orders do not depend on the units of the data; a gain scales with the values, T with omega^-a.
TEST(Fit, IsTheSameInAnyUnit) {
  const std::vector<double> omega = log_grid(1e-2, 1e3, 60);
  const Structure structure("K/(T s^a + 1)");
  for (const double value_unit : {1e-18, 1.0, 1e18}) {
    for (const double frequency_unit : {1e-9, 1.0, 1e9}) {
      for (const Weight weight : {Weight::relative, Weight::absolute}) {
        std::vector<double> scaled_omega;
        std::vector<std::complex<double>> scaled_value;
        for (const double w : omega) {
          scaled_omega.push_back(w * frequency_unit);
          scaled_value.push_back(value_unit * structure.response(std::vector<double>{0.8, 0.4, 0.7}, w));
        }
        FitOptions options;
        options.component = Component::both;
        options.weight = weight;
        const FitResult result = frac::fit({scaled_omega, scaled_value}, structure, options);
        EXPECT_NEAR(value_of(result, "a"), 0.7, 1e-8);
        EXPECT_NEAR(value_of(result, "K") / value_unit, 0.8, 1e-8);
        EXPECT_NEAR(value_of(result, "T") * std::pow(frequency_unit, 0.7), 0.4, 1e-8);
      }
    }
  }
}

// Data made by the realisation's own zeros and poles (not by the identifier's evaluation): fitted through the
// realisation the order comes back, fitted exactly it is off by the error of the realisation, some per cent on its own
// band.
TEST(Fit, ThroughOustaloupFindsTheDeployedOrder) {
  const frac::FrequencyBand band{1e-2, 1e2};
  const frac::ZeroPoleGain power = frac::oustaloup(0.6, band, 4);
  const std::vector<double> omega = log_grid(2e-2, 5e1, 80);
  std::vector<std::complex<double>> value;
  for (const double w : omega) value.push_back(2.0 / (0.5 * power.response(w) + 1.0));
  FitOptions options;
  options.component = Component::both;
  const Structure structure("K/(T s^a + 1)");
  const double exact = value_of(frac::fit({omega, value}, structure, options), "a");
  options.realisation = frac::OustaloupRealisation{band, 4};
  const FitResult through = frac::fit({omega, value}, structure, options);
  EXPECT_NEAR(value_of(through, "a"), 0.6, 1e-8);
  EXPECT_NEAR(value_of(through, "T"), 0.5, 1e-8);
  EXPECT_GT(std::abs(exact - 0.6), 1e-3);
}

TEST(Fit, ThroughGrunwaldLetnikovFindsTheDeployedOrder) {
  constexpr double sample_time = 0.05;
  constexpr std::size_t memory = 200;
  const std::vector<double> omega = log_grid(0.1, 50, 60);
  std::vector<std::complex<double>> value;
  for (const double w : omega) {
    value.push_back(2.0 / (0.5 * frac::grunwald_letnikov_response(0.6, sample_time, memory, w) + 1.0));
  }
  FitOptions options;
  options.component = Component::both;
  const Structure structure("K/(T s^a + 1)");
  const double exact = value_of(frac::fit({omega, value}, structure, options), "a");
  options.realisation = frac::GrunwaldLetnikovRealisation{sample_time, memory};
  const FitResult through = frac::fit({omega, value}, structure, options);
  EXPECT_NEAR(value_of(through, "a"), 0.6, 1e-8);
  EXPECT_GT(std::abs(exact - 0.6), 1e-3);
}

// An imaginary part says nothing about M and d; they come from the real part with c and q held.
TEST(Fit, TakesWhatTheImaginaryPartCannotSeeFromTheRealPart) {
  const FrequencyResponseData data = sample("1/(M s^2) + d + c s^q", {-2, 0.03, 0.004, 0.6}, log_grid(5, 35, 80));
  FitOptions options;
  options.component = Component::imaginary;
  for (const char* name : {"M", "d", "c"}) options.constraints.push_back({name, {}, -infinity, {}, {}});
  const FitResult result = frac::fit(data, Structure("1/(M s^2) + d + c s^q"), options);
  EXPECT_NEAR(value_of(result, "q"), 0.6, 1e-8);
  EXPECT_NEAR(value_of(result, "c"), 0.004, 1e-10);
  EXPECT_NEAR(value_of(result, "M"), -2, 1e-6);
  EXPECT_NEAR(value_of(result, "d"), 0.03, 1e-8);
  EXPECT_TRUE(estimate_of(result, "M").from_other_component);
  EXPECT_TRUE(estimate_of(result, "d").from_other_component);
  EXPECT_FALSE(estimate_of(result, "c").from_other_component);
}

// b2 wants to be 0: its logarithm runs to its bound, where the residuals no longer feel it.  It must stay there, not be
// taken from the real part, and the parameters reported must give the cost reported.
TEST(Fit, ParametersGiveTheCostEvenWhereOneVanishes) {
  std::vector<double> omega = log_grid(3, 6.6, 60);
  std::vector<std::complex<double>> value;
  for (const double w : omega) value.emplace_back(-1 / (2 * w * w), 0.0005 * std::pow(w, 0.46));
  FitOptions options;
  options.component = Component::imaginary;
  options.weight = Weight::relative;
  options.constraints = {{"K", {}, -infinity, {}, {}}};
  const FitResult result = frac::fit({omega, value}, Structure("K/(b2 s^2 + b1 s + 1)"), options);
  const auto model = frac::fitted_response(result, frac::ExactRealisation{}, omega);
  double cost = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    cost += std::pow((model[i].imag() - value[i].imag()) / std::abs(value[i]), 2);
  }
  EXPECT_NEAR(result.cost, cost, 1e-9 * cost);
  EXPECT_FALSE(estimate_of(result, "b2").from_other_component);
}

TEST(Fit, SaysThatAPhaseCannotSeeAGain) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {3, 0.4, 0.7}, log_grid(1e-2, 1e3, 60));
  FitOptions options;
  options.component = Component::phase;
  const FitResult result = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  EXPECT_FALSE(estimate_of(result, "K").identified);
  EXPECT_TRUE(std::isnan(estimate_of(result, "K").standard_error));
  EXPECT_TRUE(estimate_of(result, "a").identified);
  EXPECT_NEAR(value_of(result, "a"), 0.7, 1e-8);
}

// R0 + R1 is seen only as a sum when the data hold nothing but the plateau.
TEST(Fit, SaysThatAPlateauDoesNotSplitIntoTwoResistances) {
  const std::vector<double> omega = log_grid(1, 10, 40);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> noise(0, 0.01);
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < omega.size(); ++i) value.emplace_back(3 + noise(generator), noise(generator));
  FitOptions options;
  options.component = Component::both;
  const FitResult result = frac::fit({omega, value}, Structure("R0 + R1"), options);
  EXPECT_FALSE(estimate_of(result, "R0").identified);
  EXPECT_FALSE(estimate_of(result, "R1").identified);
  EXPECT_GT(result.condition, 1e6);
  EXPECT_NEAR(value_of(result, "R0") + value_of(result, "R1"), 3, 0.01);
}

TEST(Fit, ReportsAParameterAtItsBound) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {1, 0.4, 1.2}, log_grid(1e-2, 1e2, 60));
  FitOptions options;
  options.component = Component::both;
  options.constraints = {{"a", {}, 0, 1, {}}};
  const FitResult result = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  EXPECT_EQ(value_of(result, "a"), 1);
  EXPECT_TRUE(estimate_of(result, "a").at_bound);
  EXPECT_TRUE(std::isnan(estimate_of(result, "a").standard_error));
  EXPECT_FALSE(estimate_of(result, "K").at_bound);
}

TEST(Fit, KeepsFixedParametersAndStaysWithinBounds) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {1, 0.4, 0.7}, log_grid(1e-2, 1e2, 60));
  FitOptions options;
  options.component = Component::both;
  options.constraints = {{"a", 0.75, {}, {}, {}}, {"T", {}, 0.5, 0.9, {}}};
  const FitResult result = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  EXPECT_EQ(value_of(result, "a"), 0.75);
  EXPECT_EQ(estimate_of(result, "a").standard_error, 0);
  EXPECT_TRUE(estimate_of(result, "a").fixed);
  EXPECT_NEAR(value_of(result, "T"), 0.5, 1e-12);
  EXPECT_TRUE(estimate_of(result, "T").at_bound);
  EXPECT_EQ(result.free_parameters, 2u);
}

// Of very many points a robust fit looks for its minima on some.  With every twentieth point doubled the one it finds
// is the one that a single solve on all points finds from the truth.  Either stops where the scale of the loss has
// settled to 1e-3 of itself, which moves the minimum by a like share of the deviations that the outliers pull by: 0.1
// of a standard error.
TEST(Fit, RobustSearchOfManyPointsFindsTheMinimumOfAll) {
  const std::vector<double> truth{1, 0.4, 0.7};
  const FrequencyResponseData clean = sample("K/(T s^a + 1)", truth, log_grid(1e-2, 1e2, 45'000));
  std::mt19937_64 generator(5);
  std::normal_distribution<double> noise(0, 0.02);
  std::vector<std::complex<double>> value = clean.value();
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double size = std::abs(value[i]);
    value[i] += size * std::complex<double>(noise(generator), noise(generator));
    if (generator() % 20 == 0) value[i] *= 2;
  }
  const FrequencyResponseData data(clean.omega(), value);
  FitOptions options;
  options.loss = frac::Loss::huber;
  options.weight = Weight::relative;
  const FitResult found = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  options.global_start = false;
  options.constraints = {{"K", {}, {}, {}, truth[0]}, {"T", {}, {}, {}, truth[1]}, {"a", {}, {}, {}, truth[2]}};
  const FitResult near = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  ASSERT_TRUE(found.usable()) << found.message;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(found.parameters[i].value, near.parameters[i].value, 0.1 * near.parameters[i].standard_error) << i;
  }
}

TEST(Fit, FromGivenStartsMakesOneSolve) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {1, 0.4, 0.7}, log_grid(1e-2, 1e2, 60));
  FitOptions options;
  options.component = Component::both;
  options.global_start = false;
  options.constraints = {{"K", {}, {}, {}, 2}, {"T", {}, {}, {}, 1}, {"a", {}, {}, {}, 0.5}};
  const FitResult result = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  EXPECT_EQ(result.starts, 1u);
  EXPECT_NEAR(value_of(result, "a"), 0.7, 1e-8);
}

// Starts are searched on every n-th of many points; the fit itself must use them all: the cost is that of all, and the
// gain is the mean of a noise that alternates between the points kept and those left out.
TEST(Fit, UsesEveryPointOfALongFile) {
  const std::vector<double> omega = log_grid(1, 10, 1600);
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < omega.size(); ++i) value.emplace_back(i % 4 == 0 ? 1.03 : 0.99, 0.5);
  FitOptions options;
  options.component = Component::real;
  options.weight = Weight::absolute;
  const FitResult result = frac::fit({omega, value}, Structure("K"), options);
  EXPECT_EQ(result.residuals, 1600u);
  EXPECT_NEAR(value_of(result, "K"), (1.03 + 3 * 0.99) / 4, 1e-9);
}

// The search looks at some of many points; what is printed is the optimum of all.  Of r = G/d - 1, G = K/(T s^a + 1),
// the step of Gauss and Newton at the answer, from derivatives written out here, is the distance to the optimum to
// first order: far below 1e-8 of each parameter, where noise moves them by 1e-4.
TEST(Fit, OfManyPointsIsTheOptimumOfAll) {
  constexpr std::size_t points = 60'000;
  std::mt19937_64 random(390601);
  std::normal_distribution<double> noise(0, 0.01);
  const std::vector<double> omega = log_grid(1e-3, 1e3, static_cast<int>(points));
  std::vector<std::complex<double>> value;
  for (const double w : omega) {
    const std::complex<double> exact = 2.0 / (1.3 * std::pow(std::complex<double>(0, w), 0.7) + 1.0);
    value.push_back(exact + std::abs(exact) * std::complex<double>(noise(random), noise(random)));
  }
  FitOptions options;
  options.weight = Weight::relative;
  const FitResult result = frac::fit({omega, value}, Structure("K/(T s^a + 1)"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double k = value_of(result, "K"), t = value_of(result, "T"), a = value_of(result, "a");
  // Normal equations by logarithms of K and T and by a.
  double matrix[3][4] = {};
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const std::complex<double> s(0, omega[i]), power = t * std::pow(s, a), below = 1.0 + power, model = k / below;
    const double weight = 1 / std::norm(value[i]);
    const std::complex<double> rest = value[i] - model;
    const std::complex<double> slopes[3] = {model, -model * power / below, -model * power * std::log(s) / below};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        matrix[row][column] += weight * (std::conj(slopes[row]) * slopes[column]).real();
      matrix[row][3] += weight * (std::conj(slopes[row]) * rest).real();
    }
  }
  for (int pivot = 0; pivot < 3; ++pivot)
    for (int row = 0; row < 3; ++row) {
      if (row == pivot) continue;
      const double factor = matrix[row][pivot] / matrix[pivot][pivot];
      for (int column = pivot; column < 4; ++column) matrix[row][column] -= factor * matrix[pivot][column];
    }
  const double scale[3] = {1, 1, a};
  for (int i = 0; i < 3; ++i) EXPECT_LT(std::abs(matrix[i][3] / matrix[i][i]), 1e-8 * scale[i]) << i;
  EXPECT_NEAR(k, 2, 2e-3);
}

TEST(Fit, IsRepeatable) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {1, 0.4, 0.7}, log_grid(1e-2, 1e2, 60));
  FitOptions options;
  options.seed = 11;
  const FitResult first = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  const FitResult second = frac::fit(data, Structure("K/(T s^a + 1)"), options);
  EXPECT_EQ(first.cost, second.cost);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(first.parameters[i].value, second.parameters[i].value);
}

// The cost of the contract: the plain sum of squared relative residuals, recomputed here from the fitted curve.
TEST(Fit, CostIsThePlainSumOfSquares) {
  const std::vector<double> omega = log_grid(0.1, 10, 30);
  std::vector<std::complex<double>> value;
  for (const double w : omega) value.push_back(1.0 / std::complex<double>(1, w) + 0.05);
  FitOptions options;
  options.weight = Weight::relative;
  const FitResult result = frac::fit({omega, value}, Structure("K/(T s + 1)"), options);
  const auto model = frac::fitted_response(result, frac::ExactRealisation{}, omega);
  double cost = 0;
  for (std::size_t i = 0; i < omega.size(); ++i) cost += std::norm((model[i] - value[i]) / std::abs(value[i]));
  EXPECT_GT(cost, 1e-4);
  EXPECT_NEAR(result.cost, cost, 1e-12 * cost);
  EXPECT_NEAR(result.rms, std::sqrt(cost / 60), 1e-12);
  // AICc and BIC from their definitions, k = 2 parameters and the variance.
  EXPECT_NEAR(result.aicc, 60 * std::log(cost / 60) + 6 + 24.0 / 56, 1e-9);
  EXPECT_NEAR(result.bic, 60 * std::log(cost / 60) + 3 * std::log(60.0), 1e-9);
}

// Exact data of one structure leave parameters of another unseen by both parts: nothing may be looked for without end.
TEST(Fit, EndsOnDataThatSeeNoParameter) {
  const std::vector<double> omega = log_grid(0.1, 10, 20);
  const std::vector<std::complex<double>> constant(omega.size(), 2.0);
  for (const Component component : {Component::imaginary, Component::real, Component::both}) {
    for (const char* formula : {"E0 + E1 (1 - 1/(1 + (T s)^a)^b)", "K/(1 + (T s)^a)^b", "R0 + R1/(1 + R1 Q1 s^n1)"}) {
      FitOptions options;
      options.component = component;
      const FitResult result = frac::fit({omega, constant}, Structure(formula), options);
      EXPECT_EQ(result.termination == frac::FitTermination::no_usable_start, component == Component::imaginary)
          << formula;
      EXPECT_FALSE(result.message.empty());
    }
  }
}

// Squares of such data vanish or overflow in double; the fit must not notice.
TEST(Fit, TakesDataOfAnySize) {
  for (const double size : {1e-200, 1e200}) {
    const std::vector<double> omega = log_grid(0.1, 10, 20);
    std::vector<std::complex<double>> value;
    for (const double w : omega) value.push_back(size / std::complex<double>(1, w));
    FitOptions options;
    options.component = Component::both;
    options.weight = Weight::absolute;
    const FitResult result = frac::fit({omega, value}, Structure("K/(T s + 1)"), options);
    EXPECT_NEAR(value_of(result, "K") / size, 1, 1e-8);
    EXPECT_NEAR(value_of(result, "T"), 1, 1e-8);
  }
}

TEST(Fit, SaysWhenTheModelIsNowhereFinite) {
  const FrequencyResponseData data = sample("K", {1}, log_grid(1, 10, 10));
  const FitResult result = frac::fit(data, Structure("K/(s - s)"), FitOptions{});
  EXPECT_EQ(result.termination, frac::FitTermination::no_usable_start);
  EXPECT_TRUE(std::isnan(result.cost));
  EXPECT_FALSE(result.message.empty());
}

std::string refusal(const FrequencyResponseData& data, const char* formula, const FitOptions& options) {
  try {
    (void)frac::fit(data, Structure(formula), options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no exception";
}

void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Fit, RefusesContradictionsByName) {
  const FrequencyResponseData data = sample("K/(T s^a + 1)", {1, 0.4, 0.7}, log_grid(1e-2, 1e2, 60));
  const auto with = [&](std::vector<frac::ParameterConstraint> constraints) {
    FitOptions options;
    options.constraints = std::move(constraints);
    return refusal(data, "K/(T s^a + 1)", options);
  };
  expect_contains(with({{"Q", 1, {}, {}, {}}}), "Q");
  expect_contains(with({{"K", {}, 2, 1, {}}}), "'K'");
  expect_contains(with({{"K", 1, {}, 2, {}}}), "fixed");
  expect_contains(with({{"T", {}, {}, {}, -1}}), "start must be positive");
  expect_contains(with({{"K", {}, {}, 2, 3}}), "outside");
  expect_contains(with({{"K", NAN, {}, {}, {}}}), "finite");
  expect_contains(with({{"K", 1, {}, {}, {}}, {"K", 2, {}, {}, {}}}), "twice");
  FitOptions given;
  given.weight = Weight::given;
  expect_contains(refusal(data, "K/(T s^a + 1)", given), "standard deviation");
  FitOptions local;
  local.global_start = false;
  expect_contains(refusal(data, "K/(T s^a + 1)", local), "no start value");
  FitOptions sampled;
  sampled.realisation = frac::GrunwaldLetnikovRealisation{0.1, 10};
  expect_contains(refusal(data, "K/(T s^a + 1)", sampled), "Nyquist");
  sampled.realisation = frac::GrunwaldLetnikovRealisation{1e-3, 1'000'000};
  expect_contains(refusal(data, "K/(T s^a + 1)", sampled), "memory of 1000000");
  expect_contains(refusal({{1.0}, {{1, 1}}}, "K/(T s^a + 1)", {}), "cannot determine 3");
  FitOptions logarithmic;
  logarithmic.weight = Weight::log_complex;
  expect_contains(refusal({{1.0, 2.0}, {{1, 1}, {0, 0}}}, "K", logarithmic), "omega = 2");
}

// Of a response without real part only the imaginary one is data: a constant that goes with it stays unknown, where
// zeros taken as data would call it 0.
TEST(Fit, DataWithoutRealPartAreThoseOfTheImaginaryPart) {
  const FrequencyResponseData lag = sample("2/(0.5 s + 1)", {}, log_grid(1e-2, 1e2, 40));
  std::vector<std::complex<double>> imaginary, real, none(lag.size(), 0.0);
  for (const auto& value : lag.value()) {
    imaginary.emplace_back(0, value.imag());
    real.emplace_back(value.real(), 0);
  }
  const FrequencyResponseData without_real(lag.omega(), imaginary);
  EXPECT_EQ(frac::fitted_component(without_real, Component::both), Component::imaginary);
  EXPECT_EQ(frac::fitted_component(lag, Component::both), Component::both);
  EXPECT_EQ(frac::fitted_component({lag.omega(), real}, Component::both), Component::both);
  EXPECT_EQ(frac::fitted_component({lag.omega(), none}, Component::both), Component::both);
  std::vector<std::complex<double>> nearly = imaginary;
  nearly[7] += 1e-300;
  EXPECT_EQ(frac::fitted_component({lag.omega(), nearly}, Component::both), Component::both);
  // What is asked for by its name stays.
  for (const Component component : {Component::imaginary, Component::real, Component::magnitude, Component::phase})
    EXPECT_EQ(frac::fitted_component(without_real, component), component);

  FitOptions options;
  options.component = frac::fitted_component(without_real, options.component);
  const FitResult result = frac::fit(without_real, Structure("R + K/(T s + 1)"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  // Exact data, as in RecoversExactData.
  EXPECT_NEAR(value_of(result, "K"), 2, 2e-8);
  EXPECT_NEAR(value_of(result, "T"), 0.5, 5e-9);
  EXPECT_FALSE(estimate_of(result, "R").identified);
  EXPECT_FALSE(estimate_of(result, "R").from_other_component);
}

TEST(Fit, EnumNamesRoundTrip) {
  for (const auto component :
       {Component::imaginary, Component::real, Component::both, Component::magnitude, Component::phase}) {
    EXPECT_EQ(frac::component_from_string(frac::to_string(component)), component);
  }
  EXPECT_EQ(frac::loss_from_string("cauchy"), frac::Loss::cauchy);
  EXPECT_EQ(frac::weight_from_string("absolute"), Weight::absolute);
  EXPECT_THROW((void)frac::component_from_string("imag"), std::invalid_argument);
}

}  // namespace
