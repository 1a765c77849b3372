// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "formula/program.hpp"
#include "frac/structure.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
using Long = long double;
using LongComplex = std::complex<long double>;
using Model = std::function<LongComplex(const std::vector<Long>&, LongComplex)>;

// The formula, and the same model written out in C++ for long double.
struct Case {
  const char* formula;
  Model model;
};

LongComplex coth(LongComplex z) {
  return 1.0L / std::tanh(z);
}

const Case cases[] = {
    {"1/(b2 s^a2 + b1 s^a1 + b0)",
     [](const auto& p, LongComplex s) { return 1.0L / (p[0] * std::pow(s, p[1]) + p[2] * std::pow(s, p[3]) + p[4]); }},
    {"K exp(-L s)/(T s^a + 1)",
     [](const auto& p, LongComplex s) { return p[0] * std::exp(-p[1] * s) / (p[2] * std::pow(s, p[3]) + 1.0L); }},
    {"K/(1 + (T s)^a)^b",
     [](const auto& p, LongComplex s) { return p[0] / std::pow(1.0L + std::pow(p[1] * s, p[2]), p[3]); }},
    {"R0 + R1/(1 + R1 C1 s) + 1/(C2 s + 1/(R2 + W/((tau s)^0.5 tanh((tau s)^0.5))))",
     [](const auto& p, LongComplex s) {
       const LongComplex root = std::sqrt(p[6] * s);
       return p[0] + p[1] / (1.0L + p[1] * p[2] * s) +
              1.0L / (p[3] * s + 1.0L / (p[4] + p[5] / (root * std::tanh(root))));
     }},
    {"R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2) + 1/(Q3 s^n3)",
     [](const auto& p, LongComplex s) {
       return p[0] + p[1] / (1.0L + p[1] * p[2] * std::pow(s, p[3])) + p[4] / (1.0L + p[4] * p[5] * std::pow(s, p[6])) +
              1.0L / (p[7] * std::pow(s, p[8]));
     }},
    {"W coth(sqrt(tau s))/sqrt(tau s)",
     [](const auto& p, LongComplex s) { return p[0] * coth(std::sqrt(p[1] * s)) / std::sqrt(p[1] * s); }},
    {"tanh(A s + B + 1) - coth(C + 1 - D s)",
     [](const auto& p, LongComplex s) { return std::tanh(p[0] * s + p[1] + 1.0L) - coth(p[2] + 1.0L - p[3] * s); }},
    {"K sech(sqrt(T s)) + sinh(A s)/cosh(B s + 1)",
     [](const auto& p, LongComplex s) {
       return p[0] / std::cosh(std::sqrt(p[1] * s)) + std::sinh(p[2] * s) / std::cosh(p[3] * s + 1.0L);
     }},
    {"log(A s + B) sinh(C) cosh(D) sech(E) log(F + 1)",
     [](const auto& p, LongComplex s) {
       return std::log(p[0] * s + p[1]) * std::sinh(p[2]) * std::cosh(p[3]) / std::cosh(p[4]) * std::log(p[5] + 1.0L);
     }},
    {"(A s + B)^3/(C s - D)^2",
     [](const auto& p, LongComplex s) { return std::pow(p[0] * s + p[1], 3.0L) / std::pow(p[2] * s - p[3], 2.0L); }},
    {"sqrt(A + B s) - sqrt(C)",
     [](const auto& p, LongComplex s) { return std::sqrt(p[0] + p[1] * s) - std::sqrt(p[2]); }},
    {"K (s/w0)^(a + b) + (w1/s)^c",
     [](const auto& p, LongComplex s) { return p[0] * std::pow(s / p[1], p[2] + p[3]) + std::pow(p[4] / s, p[5]); }},
    {"exp(A - B s) tanh(C) coth(D) E^F",
     [](const auto& p, LongComplex s) {
       return std::exp(p[0] - p[1] * s) * std::tanh(p[2]) / std::tanh(p[3]) * std::pow(p[4], p[5]);
     }},
    {"(A - s)/(B + s) - (s - C)/D + exp(E)/-s",
     [](const auto& p, LongComplex s) { return (p[0] - s) / (p[1] + s) - (s - p[2]) / p[3] - std::exp(p[4]) / s; }},
    {"(1 - A s)/(B - C/(s + D))*(E - F)/(G H)",
     [](const auto& p, LongComplex s) {
       return (1.0L - p[0] * s) / (p[1] - p[2] / (s + p[3])) * (p[4] - p[5]) / (p[6] * p[7]);
     }},
    {"K", [](const auto& p, LongComplex) { return LongComplex(p[0]); }},
};

std::vector<Long> shifted(const std::vector<double>& parameters, std::size_t index, Long shift) {
  std::vector<Long> result(parameters.begin(), parameters.end());
  result[index] += shift;
  return result;
}

class StructureGradient : public testing::TestWithParam<std::size_t> {};

constexpr double on_axis = std::numbers::pi / 2;

// Reference: central difference of sixth order in long double, step 2e-5 relative.  Its rounding is 1e-19/2e-5 = 5e-15
// of |G/p|; its truncation (2e-5 x)^6/140 with x = |p dG/dp|/|G| up to 150 (angles of exp and tanh) or so, as much
// again.  The routine in double is good to some eps times the condition of the formula, x again times the cancellation
// in its sums, which stays below 50 for the parameters drawn: 2e-12 in all.
void agrees_with_differences(const Case& each, std::uint64_t seed, double angle) {
  const std::string formula = each.formula;
  const frac::Structure structure(formula);
  const frac::detail::Program program(structure.expression());
  const std::size_t count = structure.parameter_names().size();
  support::Random random(seed);
  for (int draw = 0; draw < 40; ++draw) {
    std::vector<double> parameters;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_order = structure.parameter_roles()[i] == frac::ParameterRole::order;
      parameters.push_back(is_order ? random.uniform(0.1, 1.9) : random.log_uniform(0.1, 3));
    }
    const double omega = random.log_uniform(0.02, 50);
    const LongComplex s = angle == on_axis ? LongComplex(0, omega) : std::polar(Long(omega), Long(angle));
    std::vector<Complex> gradient(count);
    Complex value;
    if (angle == on_axis) {
      value = structure.response_and_gradient(parameters, omega, frac::ExactRealisation{}, gradient);
    } else {
      program.evaluate_on_ray(parameters, angle, {&omega, 1}, {&value, 1}, gradient);
    }
    const LongComplex exact = each.model(std::vector<Long>(parameters.begin(), parameters.end()), s);
    const auto size = static_cast<double>(std::abs(exact));
    EXPECT_LT(std::abs(value - Complex(exact)), 1e-12 * (size + 1e-3)) << formula;
    for (std::size_t i = 0; i < count; ++i) {
      const Long step = 2e-5L * parameters[i];
      const auto difference = [&](int steps) {
        return each.model(shifted(parameters, i, static_cast<Long>(steps) * step), s) -
               each.model(shifted(parameters, i, -static_cast<Long>(steps) * step), s);
      };
      const LongComplex reference = (45.0L * difference(1) - 9.0L * difference(2) + difference(3)) / (60.0L * step);
      const auto scale = static_cast<double>(std::abs(reference)) + size / parameters[i];
      EXPECT_LT(std::abs(gradient[i] - Complex(reference)), 2e-12 * scale)
          << formula << ", " << structure.parameter_names()[i] << " at " << omega << ", " << angle;
    }
  }
}

TEST_P(StructureGradient, AgreesWithDifferencesInLongDouble) {
  agrees_with_differences(cases[GetParam()], 7 + GetParam(), on_axis);
}

// Those whose sums do not cancel on the real axis.
TEST(StructureGradient, HoldsOnRaysBesideTheImaginaryAxis) {
  for (std::size_t i = 0; i < 6; ++i) {
    for (const double angle : {0.0, 0.8, 1.2}) agrees_with_differences(cases[i], 31 + i, angle);
  }
}

INSTANTIATE_TEST_SUITE_P(Formulas, StructureGradient, testing::Range(std::size_t{0}, std::size(cases)));

// Through a realisation by differences of the routine's own value: with a step of 1e-3 the five-point rule is good to
// (1e-3 ln w)^4/30 < 1e-9 and loses eps/1e-3.
TEST(StructureGradient, HoldsThroughRealisations) {
  const frac::Structure structure("K exp(-L s) (A s + 1)/(T s^a + (B s)^b + 1)*1");
  const std::vector<double> parameters{2, 0.3, 0.4, 0.7, 1.4, 2.0, 0.35};
  const double d = 1e-3;
  for (const frac::Realisation& realisation : {frac::Realisation(frac::OustaloupRealisation{{1e-2, 1e3}, 7}),
                                               frac::Realisation(frac::GrunwaldLetnikovRealisation{0.01, 0}),
                                               frac::Realisation(frac::GrunwaldLetnikovRealisation{0.01, 100})}) {
    for (const double omega : {0.1, 1.0, 20.0}) {
      std::vector<Complex> gradient(parameters.size());
      const Complex value = structure.response_and_gradient(parameters, omega, realisation, gradient);
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        const auto at = [&](double shift) {
          std::vector<double> moved = parameters;
          moved[i] += shift;
          return structure.response(moved, omega, realisation);
        };
        const Complex difference = (8.0 * (at(d) - at(-d)) - (at(2 * d) - at(-2 * d))) / (12 * d);
        EXPECT_LT(std::abs(gradient[i] - difference), 1e-8 * (std::abs(value) + std::abs(difference)))
            << frac::to_string(realisation) << " " << structure.parameter_names()[i] << " " << omega;
      }
    }
  }
}

// (c s)^q at c < 0 and at c = 0, where |c|^q is not smooth.
TEST(StructureGradient, HoldsForNegativeAndZeroFactors) {
  const frac::Structure structure("(c s)^q");
  std::vector<Complex> gradient(2);
  const Complex value =
      structure.response_and_gradient(std::vector<double>{-2, 0.7}, 1.5, frac::ExactRealisation{}, gradient);
  // d/dc = q value/c and d/dq = value log(c s), by the definition of the principal value; a few roundings.
  EXPECT_LT(std::abs(gradient[0] - 0.7 * value / -2.0), 1e-15);
  EXPECT_LT(std::abs(gradient[1] - value * std::log(Complex(0, -3))), 1e-14);
  EXPECT_EQ(structure.response_and_gradient(std::vector<double>{0, 1.7}, 1.5, frac::ExactRealisation{}, gradient), 0.0);
  EXPECT_EQ(gradient[0], 0.0);
  EXPECT_EQ(gradient[1], 0.0);
}

// Saturated tanh: 1 - tanh^2 = 4 e^{-2z}, which the difference 1 - tanh^2 would have lost.
TEST(StructureGradient, KeepsItsDigitsWhereTanhSaturates) {
  const frac::Structure structure("tanh(A + s)");
  std::vector<Complex> gradient(1);
  structure.response_and_gradient(std::vector<double>{30}, 1, frac::ExactRealisation{}, gradient);
  const Complex expected = 4.0 * std::exp(-2.0 * Complex(30, 1));
  // exp amplifies the rounding of its argument 60 by 60.
  EXPECT_LT(std::abs(gradient[0] - expected), 60 * 2.2e-16 * std::abs(expected));
}

}  // namespace
