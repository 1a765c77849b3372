// SPDX-License-Identifier: BSD-3-Clause
#include "identification/residuals/linear_start.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "support/noisy_response.hpp"

namespace {

using frac::Structure;
using frac::detail::CoefficientForm;
using frac::detail::LinearWeights;

struct Case {
  const char* formula;
  std::vector<double> parameters;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"K s^a", {2.5, -0.7}},
      {"K/(T s^a + 1)", {0.8, 0.4, 0.7}},
      {"1/(b2 s^a2 + b1 s^a1 + b0)", {0.8, 2.2, 0.5, 0.9, 1}},
      {"K exp(-L s)/(b2 s^a2 + b1 s^a1 + 1)", {3, 0.1, 0.8, 2.2, 0.5, 0.9}},
      {"K/(1 + (T s)^a)", {2, 5, 0.6}},
      {"1/(C s) + R + L s", {1, 0.5, 0.2}},
      {"R0 + R1/(1 + R1 Q1 s^n1)", {1, 10, 0.2, 0.8}},
      {"(a1 s^p + a0)/(s^(2 q) + b s^q + 2)", {0.7, 0.4, 3, 0.6, 0.9}},
  };
  return all;
}

/// Parameters of role coefficient.
std::vector<std::size_t> coefficients(const Structure& structure) {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] == frac::ParameterRole::coefficient) wanted.push_back(i);
  }
  return wanted;
}

std::vector<std::complex<double>> response(const Case& test, const std::vector<double>& omega) {
  std::vector<std::complex<double>> value(omega.size());
  Structure(test.formula).response(test.parameters, omega, frac::ExactRealisation{}, value);
  return value;
}

// The form evaluated at the truth against the structure itself, which is evaluated another way: rounding only.
TEST(CoefficientForm, IsTheStructure) {
  for (const Case& test : cases()) {
    const auto form = frac::detail::coefficient_form(Structure(test.formula), test.parameters);
    ASSERT_TRUE(form) << test.formula;
    for (const double omega : {0.03, 1.0, 20.0}) {
      const auto sum = [&](const std::vector<frac::detail::CoefficientTerm>& terms) {
        std::complex<double> result = 0;
        for (const auto& term : terms) {
          result += term.value(test.parameters) * std::pow(std::complex<double>(0, omega), term.order);
        }
        return result;
      };
      const std::complex<double> value =
          std::exp(std::complex<double>(0, -omega * form->delay)) * sum(form->numerator) / sum(form->denominator);
      const std::complex<double> exact = Structure(test.formula).response(test.parameters, omega);
      EXPECT_NEAR(std::abs(value - exact), 0, 1e-13 * std::abs(exact)) << test.formula;
    }
  }
}

TEST(CoefficientForm, IsRefusedWhereThereIsNone) {
  for (const char* formula : {"K/(1 + (T s)^a)^b", "K tanh(T s)", "sqrt(1 + T s)", "K exp(-L s) + 1"}) {
    const Structure structure(formula);
    const std::vector<double> parameters(structure.parameter_names().size(), 0.6);
    EXPECT_FALSE(frac::detail::coefficient_form(structure, parameters)) << formula;
  }
}

// Exact data at the true orders leave no residual, so every weighting has the truth as its only minimum.  The columns
// are scaled; their condition on these four decades stays below 1e5, which leaves 1e-16 * 1e5 and a margin of ten.
TEST(LinearStart, RecoversExactDataAtTheTrueOrdersWithEveryWeighting) {
  const std::vector<double> omega = support::four_decades(80);
  for (const Case& test : cases()) {
    const Structure structure(test.formula);
    const auto form = frac::detail::coefficient_form(structure, test.parameters);
    const auto value = response(test, omega);
    std::vector<double> weight;
    for (const auto& each : value) weight.push_back(1 / std::abs(each));
    for (const auto weights : {LinearWeights::levy, LinearWeights::vinagre, LinearWeights::sanathanan_koerner}) {
      const auto fit = frac::detail::linear_fit(*form, omega, value, weight, weights);
      ASSERT_TRUE(fit) << test.formula;
      EXPECT_EQ(fit->rank, fit->unknowns) << test.formula;
      for (std::size_t i = 0; i < form->numerator.size(); ++i) {
        const double truth = form->numerator[i].value(test.parameters);
        EXPECT_NEAR(fit->numerator[i], truth, 1e-10 * std::abs(truth)) << test.formula;
      }
      for (std::size_t i = 0; i < form->denominator.size(); ++i) {
        const double truth = form->denominator[i].value(test.parameters);
        EXPECT_NEAR(fit->denominator[i], truth, 1e-10 * std::abs(truth)) << test.formula;
      }
    }
  }
}

// Coefficients back to parameters, from parameters a factor 2 off.  Products come back by one linear solve, sums by
// steps that end when they no longer gain.
TEST(LinearStart, FindsTheParametersBehindTheCoefficients) {
  const std::vector<double> omega = support::four_decades(80);
  for (const Case& test : cases()) {
    const Structure structure(test.formula);
    const auto form = frac::detail::coefficient_form(structure, test.parameters);
    const auto value = response(test, omega);
    const std::vector<double> weight(omega.size(), 1.0);
    const auto fit = frac::detail::linear_fit(*form, omega, value, weight, LinearWeights::sanathanan_koerner);
    ASSERT_TRUE(fit);
    const std::vector<std::size_t> wanted = coefficients(structure);
    std::vector<double> near = test.parameters;
    for (const std::size_t i : wanted) near[i] *= i % 2 == 0 ? 2 : 0.5;
    const auto found = frac::detail::parameters_from(*form, *fit, near, wanted);
    ASSERT_TRUE(found) << test.formula;
    for (std::size_t i = 0; i < near.size(); ++i) {
      EXPECT_NEAR((*found)[i], test.parameters[i], 1e-6 * std::abs(test.parameters[i])) << test.formula;
    }
  }
}

// Two terms of one order: one column too many.  Orders 3e-9 apart are two terms to the form and one to the data, whose
// columns differ by 3e-9 ln 100.
TEST(LinearStart, ReportsAMissingRank) {
  const std::vector<double> omega = support::four_decades(40);
  const Case lag{"1/(b1 s^a1 + b0)", {0.5, 0.9, 1}};
  const auto form = frac::detail::coefficient_form(Structure("1/(b2 s^a2 + b1 s^a1 + b0)"),
                                                   std::vector<double>{1, 0.900000003, 1, 0.9, 1});
  const auto fit = frac::detail::linear_fit(*form, omega, response(lag, omega), std::vector<double>(omega.size(), 1.0),
                                            LinearWeights::levy);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->unknowns, 3u);
  EXPECT_LT(fit->rank, 3u);
}

}  // namespace
