// SPDX-License-Identifier: BSD-3-Clause
#include "formula/cut_plane.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "formula/program.hpp"
#include "frac/structure.hpp"
#include "support/random.hpp"
#include "time_response/cut_plane_model.hpp"
#include "time_response/event_response.hpp"
#include "time_response/steady_response.hpp"

namespace {

using frac::Hold;
using frac::Structure;
using frac::detail::CutPlaneModel;
using frac::detail::EventResponse;
using frac::detail::Sensitivity;
using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

bool is_analytic(const std::string& formula, const std::vector<double>& parameters = {}) {
  return frac::detail::is_analytic_in_cut_plane(Structure(formula).expression(), parameters);
}

TEST(CutPlane, HoldsRelaxationAndDiffusion) {
  for (const char* formula :
       {"1/sqrt(1 + 2 s)", "1/(1 + 2 s)^0.3", "1/(1 + (2 s)^0.9)^0.4", "1/(1 + s^0.999)", "3", "0*tanh(sqrt(s)) + 1",
        "tanh(sqrt(2 s))/sqrt(2 s)", "0.1 + 2 coth(sqrt(2 s))/sqrt(2 s)", "1/cosh(sqrt(2 s))", "sech(s^0.5)",
        "sinh(0.3 sqrt(s))/sinh(sqrt(s))", "exp(-sqrt(2 s))", "1/((3 s + 1) cosh(sqrt(2 s)))",
        "tanh(sqrt(2 s + 1))/sqrt(2 s + 1)", "1 - 1/sqrt(1 + s)", "-s^0.4", "1/(s + 2 sqrt(s) + 3)", "log(1 + 1/s)"}) {
    EXPECT_TRUE(is_analytic(formula)) << formula;
  }
}

// Each has a pole or a branch point at s = 1, at a complex s before the axis, or on the imaginary axis, or outgrows
// e^{s t}.
TEST(CutPlane, LeavesOutPolesOffTheAxisAndDeadTimes) {
  for (const char* formula : {"1/(1 - s)",
                              "1/(s^0.5 - 1)",
                              "1/(1 + s^1.2)",
                              "1/(1 + s + s^2)",
                              "tanh(s)",
                              "tanh(s^0.6)",
                              "sqrt(s - 1)",
                              "1/(1 + s^1.2)^0.5",
                              "exp(-s)",
                              "exp(sqrt(s))",
                              "1/cosh(s)",
                              "1/(tanh(sqrt(s)) - 0.5)",
                              "log(1 - s)",
                              "1/(2 - sqrt(s))",
                              "1/(s^1.0000000000001 - 1)",
                              "1/(s/s^0 - 1)",
                              "1/(s*tanh(sqrt(s))^0 - 1)",
                              "0*(1/(s^2 + s + 1)) + 1",
                              "tanh(-sqrt(s))/(1 - s)",
                              "1/(exp(-sqrt(s)) - 0.5)"}) {
    EXPECT_FALSE(is_analytic(formula)) << formula;
  }
  EXPECT_TRUE(is_analytic("1/sqrt(1 + T s)", {2}));
  EXPECT_FALSE(is_analytic("1/sqrt(1 + T s)", {-2}));
  EXPECT_FALSE(is_analytic("1/sqrt(1 + T s)", {std::nan("")}));
}

// Integral of G along the edge of a part of the upper half plane, over that of |G|: by Cauchy's theorem 0 where no
// singularity lies within, the sum of residues, of the size of the integrand, where poles do.
double around(const Structure& structure, const std::vector<double>& parameters) {
  const frac::detail::Program program(structure.expression());
  constexpr double lower = -6, upper = 6, last = 0.98 * pi;
  constexpr int along = 6'000, across = 2'000;
  Complex sum = 0;
  double size = 0;
  const auto add = [&](double log_s, double angle, Complex step) {
    const double modulus = std::exp(log_s);
    Complex value;
    program.evaluate_on_ray(parameters, angle, {&modulus, 1}, {&value, 1}, {});
    const Complex part = value * std::polar(modulus, angle) * step;  // ds = s d ln s
    sum += part;
    size += std::abs(part);
  };
  for (int i = 0; i < along; ++i) {
    const double log_s = lower + (upper - lower) * (i + 0.5) / along, step = (upper - lower) / along;
    add(log_s, 0, step);
    add(log_s, last, -step);
  }
  for (int i = 0; i < across; ++i) {
    const double angle = last * (i + 0.5) / across, step = last / across;
    add(upper, angle, Complex(0, step));
    add(lower, angle, Complex(0, -step));
  }
  return std::abs(sum) / size;
}

// The midpoint rule errs by (step/distance)^2: the steps are 2e-3, the nearest poles on the axis .06 away, and a
// residue beside all of the integrand counts for more than the bound in between.
TEST(CutPlane, WhatIsHeldHasNoSingularityWithin) {
  support::Random random(4);
  int held = 0, left_out = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const auto pick = [&](const std::vector<std::string>& from) {
      return from[static_cast<std::size_t>(random.unit() * static_cast<double>(from.size()))];
    };
    const auto number = [&] { return std::to_string(random.log_uniform(0.1, 10)); };
    const auto signed_number = [&] { return (random.unit() < 0.15 ? "-" : "") + number(); };
    const auto order = [&] { return std::to_string(random.uniform(0.2, 1.2)); };
    const std::vector<std::string> arguments{"sqrt(" + number() + " s)", "s^" + order(),
                                             "sqrt(" + number() + " s + " + number() + ")"};
    const std::vector<std::string> parts{"1",
                                         "tanh(" + pick(arguments) + ")",
                                         "coth(" + pick(arguments) + ")",
                                         "sech(" + pick(arguments) + ")",
                                         "exp(-" + pick(arguments) + ")",
                                         "(1 + " + number() + " s^" + order() + ")^" + order(),
                                         "s^" + order(),
                                         "(" + signed_number() + " + sqrt(s))"};
    const std::string more = random.unit() < 0.5 ? "" : " + " + pick(parts) + "*" + pick(parts);
    const std::string formula = "(" + signed_number() + "*" + pick(parts) + " + " + pick(parts) + ")/(" +
                                signed_number() + "*" + pick(parts) + more + ")";
    if (is_analytic(formula)) {
      ++held;
      EXPECT_LT(around(Structure(formula), {}), 1e-4) << formula;
    } else {
      ++left_out;
    }
  }
  EXPECT_GT(held, 60);
  EXPECT_GT(left_out, 100);
}

TEST(CutPlane, TheIntegralAroundAPoleTellsOfIt) {
  EXPECT_GT(around(Structure("tanh(s^0.8)"), {}), 1e-3);
  EXPECT_GT(around(Structure("1/(1 + s^1.2)"), {}), 1e-3);
}

double series(double t, double first, double sign) {
  double sum = 0;
  for (int k = 0; k < 4000; ++k) {
    const double root = (k + first) * pi, part = 2 / (root * root) * std::exp(-root * root * t);
    sum += (k % 2 == 0 ? 1 : sign) * part * (sign < 0 ? root : 1);
    if (part < 1e-18) break;
  }
  return sum;
}

struct Known {
  const char* formula;
  std::vector<double> parameters;
  double (*step)(double t);
  double (*ramp)(double t);  // its integral; null: not known
};

const std::vector<Known>& known() {
  static const std::vector<Known> all{
      {"R/sqrt(1 + T s)",
       {2, 0.5},
       [](double t) { return 2 * std::erf(std::sqrt(t / 0.5)); },
       [](double t) {
         return 2 * ((t - 0.25) * std::erf(std::sqrt(t / 0.5)) + std::sqrt(0.5 * t / pi) * std::exp(-t / 0.5));
       }},
      {"R/(1 + T s)^b",
       {3, 0.7, 0.35},
       [](double t) { return 3 * boost::math::gamma_p(0.35, t / 0.7); },
       [](double t) {
         return 3 * (t * boost::math::gamma_p(0.35, t / 0.7) - 0.7 * 0.35 * boost::math::gamma_p(1.35, t / 0.7));
       }},
      {"R0 + R1 tanh(sqrt(T s))/sqrt(T s)",
       {0.3, 2, 4},
       [](double t) { return 0.3 + 2 * (1 - series(t / 4, 0.5, 1)); },
       nullptr},
      {"R0 + R1 coth(sqrt(T s))/sqrt(T s)",
       {0.3, 2, 4},
       [](double t) { return 0.3 + 2 * (t / 4 + 1.0 / 3 - series(t / 4, 1, 1)); },
       nullptr},
      {"K/cosh(sqrt(T s))", {2, 4}, [](double t) { return 2 * (1 - series(t / 4, 0.5, -1)); }, nullptr},
      {"K exp(-sqrt(T s))", {2, 4}, [](double t) { return 2 * std::erfc(1 / std::sqrt(t)); }, nullptr}};
  return all;
}

CutPlaneModel model_of(const Structure& structure, const std::vector<double>& parameters,
                       Sensitivity sensitivity = Sensitivity::all) {
  auto model = CutPlaneModel::of(structure, parameters, sensitivity);
  if (!model) throw std::runtime_error(structure.formula() + " is not held");
  return *std::move(model);
}

// Series and special functions are known to 1e-15 of 1, the integral along the cut to the tolerance asked for over its
// parts, some twenty of which add up.
TEST(CutPlaneResponse, OfAStepIsTheKnownOne) {
  std::vector<double> time{0};
  for (double t = 1e-3; t < 30; t *= 1.3) time.push_back(t);
  for (const Known& each : known()) {
    const Structure structure(each.formula);
    const EventResponse step({0, 40}, {1, 1}, Hold::zero_order, {time.begin() + 1, time.end()});
    for (const double tolerance : {1e-6, 1e-13}) {
      EventResponse::Result found;
      ASSERT_TRUE(step.evaluate(model_of(structure, each.parameters), tolerance, found)) << each.formula;
      for (std::size_t i = 1; i < time.size(); ++i) {
        EXPECT_NEAR(found.value[static_cast<Eigen::Index>(i) - 1], each.step(time[i]),
                    std::max(20 * tolerance, 1e-12) * std::max(1.0, std::abs(each.step(30))))
            << each.formula << " at " << time[i];
      }
    }
  }
}

// A jump passes at once where the formula tends to a constant.
TEST(CutPlaneResponse, AtAJumpItIsWhatTheFormulaTendsTo) {
  const EventResponse step({0, 1}, {1, 1}, Hold::zero_order, {0, 1});
  for (const Known& each : known()) {
    EventResponse::Result found;
    ASSERT_TRUE(step.evaluate(model_of(Structure(each.formula), each.parameters), 1e-13, found));
    EXPECT_NEAR(found.value[0], std::string_view(each.formula).starts_with("R0") ? 0.3 : 0, 1e-15) << each.formula;
  }
}

TEST(CutPlaneResponse, OfSamplesIsTheSumOfStepsAndRamps) {
  support::Random random(9);
  std::vector<double> time{0}, input{0.7};
  while (time.size() < 60) {
    time.push_back(time.back() + random.log_uniform(1e-2, 0.3));
    input.push_back(random.normal());
  }
  for (const Known& each : known()) {
    for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
      if (hold == Hold::first_order && !each.ramp) continue;
      const EventResponse response(time, input, hold, time);
      EventResponse::Result found;
      ASSERT_TRUE(response.evaluate(model_of(Structure(each.formula), each.parameters), 1e-13, found));
      for (std::size_t i = 1; i < time.size(); ++i) {
        double expected = 0, before = 0, slope = 0;
        for (std::size_t n = 0; n < i; ++n) {
          const double since = time[i] - time[n];
          if (hold == Hold::zero_order || n == 0) {
            expected += (input[n] - before) * each.step(since);
            before = input[n];
          }
          if (hold == Hold::zero_order) continue;
          const double next = (input[n + 1] - input[n]) / (time[n + 1] - time[n]);
          expected += (next - slope) * each.ramp(since);
          slope = next;
        }
        if (hold == Hold::zero_order && each.formula[1] == '0') expected += (input[i] - before) * 0.3;
        EXPECT_NEAR(found.value[static_cast<Eigen::Index>(i)], expected, 1e-11) << each.formula << " at " << time[i];
      }
    }
  }
}

// Central differences of step 1e-5 err by 1e-10 of the third derivative and by rounding over the step, 1e-10.
TEST(CutPlaneResponse, DerivativesAreThoseOfTheValues) {
  const EventResponse response({0, 1, 1.5}, {1, -0.5, -0.5}, Hold::zero_order, {0.01, 0.4, 1, 1.1, 4});
  std::vector<Known> all = known();
  all.push_back({"R/(1 + (T s)^a)^b", {3, 0.7, 0.8, 0.35}, nullptr, nullptr});
  for (const Known& each : all) {
    const Structure structure(each.formula);
    EventResponse::Result found;
    ASSERT_TRUE(response.evaluate(model_of(structure, each.parameters), 1e-13, found));
    for (std::size_t p = 0; p < each.parameters.size(); ++p) {
      std::vector<double> less = each.parameters, more = each.parameters;
      const double step = 1e-5 * each.parameters[p];
      less[p] -= step;
      more[p] += step;
      EventResponse::Result below, above;
      ASSERT_TRUE(response.evaluate(model_of(structure, less, Sensitivity::none), 1e-13, below));
      ASSERT_TRUE(response.evaluate(model_of(structure, more, Sensitivity::none), 1e-13, above));
      EXPECT_EQ(below.gradient.cols(), 0);
      const Eigen::VectorXd difference = (above.value - below.value) / (2 * step);
      EXPECT_LT((found.gradient.col(static_cast<Eigen::Index>(p)) - difference).cwiseAbs().maxCoeff(), 3e-8)
          << each.formula << ", parameter " << p;
    }
  }
}

// As a ratio and as another formula, which differ in how they are integrated.
TEST(CutPlaneResponse, AgreesWithThatOfARatio) {
  const EventResponse response({0, 1, 1.5}, {1, -0.5, -0.5}, Hold::zero_order, {1e-3, 0.01, 0.4, 1, 1.1, 4, 1000});
  for (const auto& [formula, parameters] :
       std::vector<std::pair<const char*, std::vector<double>>>{{"K/(T s^a + 1)", {2, 1.5, 0.7}},
                                                                {"K/((T s + 1) (2 s^0.5 + 1))", {2, 1.5}},
                                                                {"K + W/s^a", {0.2, 1.5, 0.4}},
                                                                {"K/(s (T s^a + 1))", {2, 1.5, 0.7}},
                                                                {"K (1 + s^0.3)/s^1.6", {2}}}) {
    const Structure structure(formula);
    EventResponse::Result along, ratio;
    ASSERT_TRUE(response.evaluate(model_of(structure, parameters), 1e-13, along)) << formula;
    ASSERT_TRUE(response.evaluate(reduce(structure.expression(), parameters, Sensitivity::all), 1e-13, ratio));
    EXPECT_LT((along.value - ratio.value).cwiseAbs().maxCoeff(), 1e-11 * ratio.value.cwiseAbs().maxCoeff()) << formula;
    EXPECT_LT((along.gradient - ratio.gradient).cwiseAbs().maxCoeff(),
              1e-10 * (1 + ratio.gradient.cwiseAbs().maxCoeff()))
        << formula;
  }
}

// Powers of s that fall so slowly that no s shows what they tend to, and terms that cancel at the origin.
TEST(CutPlaneResponse, LimitsAreThoseOfTheLeadingTerms) {
  const auto at_jump = [](const char* formula, const std::vector<double>& parameters) {
    const EventResponse step({0, 1}, {1, 1}, Hold::zero_order, {0, 1});
    EventResponse::Result found;
    EXPECT_TRUE(step.evaluate(model_of(Structure(formula), parameters), 1e-13, found)) << formula;
    return found;
  };
  const auto slow = at_jump("R0 + R1/(1 + (T s)^0.2)^0.5", {0.3, 2, 4});
  EXPECT_NEAR(slow.value[0], 0.3, 1e-15);
  EXPECT_NEAR(slow.gradient(0, 0), 1, 1e-9);
  EXPECT_NEAR(slow.gradient(0, 1), 0, 1e-9);
  EXPECT_NEAR(at_jump("K tanh(s^-0.5 + 0.7)", {2}).value[0], 2 * std::tanh(0.7), 1e-15);
  EXPECT_NEAR(at_jump("K (1 + s)/(2 + 3 s + sqrt(s))", {2}).value[0], 2.0 / 3, 1e-15);
  EXPECT_EQ(at_jump("K/cosh(sqrt(T s))", {2, 1}).value[0], 0);
  // Steps: 1 less that of another formula; the integral of one.
  const auto layer = at_jump("K (1 - 1/cosh(sqrt(T s)))", {2, 4});
  EXPECT_NEAR(layer.value[1], 2 - 2 * (1 - series(0.25, 0.5, -1)), 1e-11);
  const auto slab = at_jump("K (coth(sqrt(T s))/sqrt(T s) - 1/(T s))", {2, 1.37});
  EXPECT_NEAR(slab.value[1], 2 * (1.0 / 3 - series(1 / 1.37, 1, 1)), 1e-10);
  // e^(-a sqrt(s))/s^1.5 is the transform of 2 sqrt(t/pi) e^(-a^2/(4 t)) - a erfc(a/(2 sqrt(t))).
  const auto half = at_jump("K (1 - exp(-sqrt(T s)))/sqrt(T s)", {2, 4});
  EXPECT_NEAR(half.value[1], 2 * (std::sqrt(1 / pi) * (1 - std::exp(-1)) + std::erfc(1)), 1e-11);
}

// Times ten decades from the samples, either way, and what is improper.
TEST(CutPlaneResponse, FarFromTheSamplesAndBeyondThem) {
  const std::vector<double> time{1e-3, 1e-2, 1};
  const EventResponse step({0, 2}, {1, 1}, Hold::zero_order, time);
  EventResponse::Result found;
  ASSERT_TRUE(step.evaluate(model_of(Structure("K/cosh(sqrt(T s))"), {1, 1e10}), 1e-12, found));
  EXPECT_LT(found.value.cwiseAbs().maxCoeff(), 1e-12);
  ASSERT_TRUE(step.evaluate(model_of(Structure("K/cosh(sqrt(T s))"), {1, 1e-10}), 1e-12, found));
  EXPECT_LT((found.value.array() - 1).abs().maxCoeff(), 1e-11);
  ASSERT_TRUE(step.evaluate(model_of(Structure("R/sqrt(1 + T s)"), {1, 1e10}), 1e-12, found));
  for (std::size_t i = 0; i < time.size(); ++i)
    EXPECT_NEAR(found.value[static_cast<Eigen::Index>(i)] / std::erf(std::sqrt(time[i] / 1e10)), 1, 1e-10);
  EXPECT_FALSE(step.evaluate(model_of(Structure("K sqrt(1 + T s)"), {1, 1}), 1e-12, found));
  EXPECT_FALSE(step.evaluate(model_of(Structure("K cosh(sqrt(T s))"), {1, 1}), 1e-12, found));
}

TEST(CutPlaneResponse, InTheSteadyStateIsThatOfItsLines) {
  std::vector<double> time, input;
  for (int i = 0; i < 64; ++i) {
    time.push_back(0.1 * i);
    const double phase = 2 * pi * i / 32;
    input.push_back(0.4 + std::cos(phase) + 0.3 * std::sin(5 * phase));
  }
  std::vector<std::size_t> all(time.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  const frac::detail::SteadyResponse steady(std::make_shared<frac::detail::PeriodicInput>(time, input), all);
  const Structure structure("R0 + R1 tanh(sqrt(T s))/sqrt(T s)");
  const std::vector<double> parameters{0.3, 2, 4};
  EventResponse::Result found;
  ASSERT_TRUE(steady.evaluate(model_of(structure, parameters), found));
  const double omega = 2 * pi / 3.2;
  for (std::size_t i = 0; i < time.size(); ++i) {
    const Complex first = std::polar(1.0, omega * time[i]), fifth = std::polar(1.0, 5 * omega * time[i]);
    const double expected = 0.4 * 2.3 + (structure.response(parameters, omega) * first).real() +
                            0.3 * (structure.response(parameters, 5 * omega) * fifth).imag();
    EXPECT_NEAR(found.value[static_cast<Eigen::Index>(i)], expected, 1e-13);
  }
}

// 1/cosh z as it overflows nowhere, with its derivative, alone and among other factors.
TEST(BoundedReciprocals, AreThoseOfTheDivisors) {
  const std::vector<double> omega{1e-3, 0.1, 1, 30, 1e3};
  for (const auto& [plain, same] : std::vector<std::pair<const char*, const char*>>{
           {"K/cosh(sqrt(T s))", "K sech(sqrt(T s))"},
           {"K/((T s + 1) cosh(sqrt(T s)))", "K sech(sqrt(T s))/(T s + 1)"},
           {"K/(cosh(sqrt(T s)) (T s + 1) (s + 2))", "K sech(sqrt(T s))/((T s + 1) (s + 2))"},
           {"K/cosh(sqrt(T s))^2", "K sech(sqrt(T s))^2"},
           {"K s/(2 cosh(sqrt(T s)) cosh(sqrt(s)))", "K s sech(sqrt(T s)) sech(sqrt(s))/2"},
           {"(K + sinh(sqrt(T s)))/cosh(sqrt(T s))", "K sech(sqrt(T s)) + tanh(sqrt(T s))"}}) {
    const Structure one(plain), other(same);
    for (const double w : omega) {
      std::vector<Complex> gradient(2), of_other(2);
      const std::vector<double> parameters{1.3, 0.7};
      const auto at = [&](const Structure& structure, std::vector<Complex>& slope) {
        std::vector<double> ordered(2);
        ordered[structure.parameter_index("K")] = parameters[0];
        ordered[structure.parameter_index("T")] = parameters[1];
        const Complex value = structure.response_and_gradient(ordered, w, frac::ExactRealisation{}, slope);
        if (structure.parameter_index("K") == 1) std::swap(slope[0], slope[1]);
        return value;
      };
      const Complex value = at(one, gradient), expected = at(other, of_other);
      EXPECT_LT(std::abs(value - expected), 1e-14 * std::abs(expected)) << plain << " at " << w;
      for (std::size_t p = 0; p < 2; ++p)
        EXPECT_LE(std::abs(gradient[p] - of_other[p]), 1e-13 * std::max(std::abs(of_other[p]), std::abs(expected)))
            << plain << " at " << w;
    }
    if (std::string_view(plain).starts_with("(")) continue;
    std::vector<Complex> gradient(2);
    EXPECT_EQ(one.response_and_gradient(std::vector{1.3, 0.7}, 1e9, frac::ExactRealisation{}, gradient), 0.0) << plain;
  }
}

// cosh(2 j) is negative, and its root the principal one.
TEST(BoundedReciprocals, RootsOfCoshStayPrincipal) {
  const Complex expected = 1.0 / std::sqrt(std::cosh(Complex(0, 2)));
  EXPECT_LT(std::abs(Structure("1/cosh(s)^0.5").response({}, 2) - expected), 1e-15);
}

}  // namespace
