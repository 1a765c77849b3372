// SPDX-License-Identifier: BSD-3-Clause
#include "time_response/event_response.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/exact_output.hpp"
#include "support/random.hpp"
#include "support/step_systems.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::Hold;
using frac::Structure;
using frac::detail::EventResponse;
using frac::detail::reduce;
using frac::detail::Sensitivity;

struct Case {
  const char* formula;
  std::vector<double> parameters;
};

// Poles on either side of the cut and on it, a double one, integrators, direct feedthrough, dead time, a right-half
// plane zero and pole, orders above 2, ratios of polynomials, numbers on either side of every sign of arithmetic.
const std::vector<Case>& cases() {
  static const std::vector<Case> all{{"1/(a2 s^q2 + a1 s^q1 + 1)", {0.8, 2.2, 0.5, 0.9}},
                                     {"K exp(-L s)/(T s^a + 1)", {2, 0.513, 1.5, 0.6}},
                                     {"K/(T s^a + 1)", {2, 1.5, 0.99}},
                                     {"K/(T s^a + 1)", {2, 1.5, 1}},
                                     {"(b s^a + 1)/(s^a + c)", {2, 0.5, 3}},
                                     {"K/(s (T s^a + 1))", {0.7, 1.2, 0.8}},
                                     {"K (s^a + 1)/s^b", {0.7, 0.5, 2.3}},
                                     {"K/s^a", {2, 0.4}},
                                     {"K/(s^2 + 2 c s + 1)", {1, 1}},
                                     {"(1 - T s^a)/(s^b + s^a + 1)", {0.7, 0.8, 1.6}},
                                     {"K/(s^a - c)", {1, 1.2, 0.3}},
                                     {"K/(s^a + 1)", {1, 3.5}},
                                     {"Kp + Ki/s", {1, 2}},
                                     {"(b s + 1)/(s^2 + c s + w)", {0.7, 0.4, 2.5}},
                                     {"K exp(-L s)/((s + p) (s + q) (s^2 + c s + 4))", {3, 0.513, 0.2, 9, 0.1}},
                                     {"K (s + z)/(s (s - p) (s + q))", {0.3, 2, 0.2, 3}},
                                     {"(s^2 + b s + 1)/((s + p) (s + 1.3))", {0.7, 30}},
                                     {"Kp + Ki/s^l + Kd s^d/(0.01 s + 1)", {1, 2, 0.9, 0.3, 0.7}},
                                     {"c - K/(T s^a + 1)/b", {0.3, 2, 1.5, 0.6, 0.8}},
                                     {"(K/(s + p) - c)/d + 2 (a1/(b1 s^q1 + 1) + a2/(b2 s + 1) + 1/(s + w)/v)",
                                      {1, 0.2, 0.3, 0.7, 2, 1.5, 0.8, -1, 4, 9, 0.5}}};
  return all;
}

std::vector<double> uneven_times(std::size_t count) {
  support::Random random(7);
  std::vector<double> time{0};
  while (time.size() < count) time.push_back(time.back() + random.log_uniform(1e-3, 0.3));
  return time;
}

std::vector<double> switched_input(const std::vector<double>& time) {
  support::Random random(8);
  std::vector<double> input;
  for (std::size_t i = 0; i < time.size(); ++i) {
    input.push_back(i == 0 || random.unit() < 0.2 ? random.normal() : input.back());
  }
  return input;
}

double largest(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

EventResponse::Result evaluated(const Case& each, const EventResponse& events, double tolerance,
                                Sensitivity sensitivity = Sensitivity::none) {
  EventResponse::Result result;
  EXPECT_TRUE(
      events.evaluate(reduce(Structure(each.formula).expression(), each.parameters, sensitivity), tolerance, result))
      << each.formula;
  return result;
}

}  // namespace

TEST(EventResponse, IsTheSumOfExactResponsesAtUnevenTimes) {
  const std::vector<double> time = uneven_times(120);
  const std::vector<double> input = switched_input(time);
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    const EventResponse events(time, input, hold, time);
    for (const Case& each : cases()) {
      const auto model = to_transfer_function(Structure(each.formula), each.parameters);
      const std::vector<double> exact = support::exact_output(model, time, input, hold);
      // Tolerance 1e-11 of each of some thirty steps of the input.
      const auto result = evaluated(each, events, 1e-11);
      for (std::size_t i = 0; i < time.size(); ++i) {
        EXPECT_NEAR(result.value[static_cast<Eigen::Index>(i)], exact[i], 3e-10 * std::max(3.0, largest(exact)))
            << each.formula << " " << i;
      }
    }
  }
}

TEST(EventResponse, MeetsTheToleranceOnTheStepOfEverySystem) {
  std::vector<double> time{0};
  for (double t = 1e-6; t < 40; t *= 1.3) time.push_back(t);
  const EventResponse events({0}, {1}, Hold::zero_order, time);
  std::vector<FractionalTransferFunction> models;
  for (const auto& [name, system] : support::step_systems()) models.push_back(system.model);
  for (const std::string& text : support::hard_systems()) models.push_back(FractionalTransferFunction::parse(text));
  for (const auto& model : models) {
    const std::string formula = model.formula();
    const auto exact = frac::reference_response(model, {}, time);
    double size = 0;
    for (const auto& value : exact) size = std::max(size, std::abs(value.value));
    for (const double tolerance : {1e-4, 1e-8, 1e-11}) {
      const auto result = evaluated({formula.c_str(), {}}, events, tolerance);
      for (std::size_t i = 0; i < time.size(); ++i) {
        // Parts that cancel, beside a double pole or with three roots together, may be ten times the whole.
        EXPECT_NEAR(result.value[static_cast<Eigen::Index>(i)], exact[i].value, 10 * tolerance * size)
            << formula << " " << time[i];
      }
    }
  }
}

// Central differences with step h of values that err by 1e-13: h^2 of the third derivative plus 1e-13/h, below 1e-7 at
// h = 1e-5 where the response is smooth in the parameter.  In the dead time it is as smooth as over time: a millisecond
// after a step (t - L)^0.6 asks for a shorter step.
TEST(EventResponse, DerivativesAgreeWithDifferences) {
  const std::vector<double> time = uneven_times(60);
  const std::vector<double> input = switched_input(time);
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    const EventResponse events(time, input, hold, time);
    for (const Case& each : cases()) {
      const auto result = evaluated(each, events, 1e-12, Sensitivity::all);
      for (std::size_t p = 0; p < each.parameters.size(); ++p) {
        Case above = each, below = each;
        const bool is_delay = Structure(each.formula).parameter_roles()[p] == frac::ParameterRole::delay;
        const double step = is_delay ? 1e-6 : 1e-5;
        above.parameters[p] += step;
        below.parameters[p] -= step;
        const Eigen::VectorXd difference =
            (evaluated(above, events, 1e-13).value - evaluated(below, events, 1e-13).value) / (2 * step);
        const double size = difference.cwiseAbs().maxCoeff();
        const Eigen::VectorXd error = (result.gradient.col(static_cast<Eigen::Index>(p)) - difference).cwiseAbs();
        EXPECT_LE(error.maxCoeff(), (is_delay ? 1e-5 : 1e-6) * std::max(1.0, size)) << each.formula << " " << p;
      }
    }
  }
}

// Two poles d apart with a residue each lose rounding/d^2, up to 1e-11 here.  The rule along a cut before them loses
// nothing: the tolerance holds, with some hundred roundings of parts that add up to 10 at most.
TEST(EventResponse, KeepsItsDigitsWhereTwoPolesPart) {
  std::vector<double> time{0};
  while (time.size() < 60) time.push_back(time.back() + 0.1);
  const EventResponse events({0}, {1}, Hold::zero_order, time);
  for (int i = 0; i <= 30; ++i) {
    const double c = 1 - 1e-6 * std::pow(10, i / 10.0);
    const auto result = evaluated({"1/(s^2 + 2 c s + 1)", {c}}, events, 1e-13);
    const long double damping = c;
    const long double omega = std::sqrt((1 - damping) * (1 + damping));
    for (std::size_t n = 1; n < time.size(); ++n) {
      const long double t = time[n];
      const long double exact =
          1 - std::exp(-damping * t) * (std::cos(omega * t) + damping / omega * std::sin(omega * t));
      EXPECT_NEAR(result.value[static_cast<Eigen::Index>(n)], static_cast<double>(exact), 2e-13) << c << " " << t;
    }
  }
}

TEST(EventResponse, SaysWhereThereIsNoResponse) {
  const EventResponse events({0}, {1}, Hold::zero_order, {0, 1, 2});
  EventResponse::Result result;
  for (const char* formula : {"s^0.5", "1/s^9.5", "1/(s - 800)"}) {
    EXPECT_FALSE(events.evaluate(reduce(Structure(formula).expression(), {}), 1e-8, result)) << formula;
  }
  ASSERT_TRUE(events.evaluate(reduce(Structure("exp(-5 s)/(s + 1)").expression(), {}), 1e-8, result));
  EXPECT_EQ(result.value, Eigen::VectorXd::Zero(3));
}

// G s^2 grows as s^1.5, so that states of weight 1e6 cancel against the twofold integral of the input: some 1e-15 of
// their product, which is 1e-8 of the output here.
TEST(EventResponse, IntegratorsWithAFastWayThroughCostDigits) {
  const std::vector<double> time = uneven_times(120);
  const std::vector<double> input = switched_input(time);
  const EventResponse events(time, input, Hold::zero_order, time);
  for (const Case& each : {Case{"(s^a + b)/s^2", {1.5, 0.7}}, {"(s^2 + s^a + b)/(s^2 (s^c + 1))", {1.2, 0.7, 0.4}}}) {
    const auto model = to_transfer_function(Structure(each.formula), each.parameters);
    const std::vector<double> exact = support::exact_output(model, time, input, Hold::zero_order);
    const auto result = evaluated(each, events, 1e-11);
    for (std::size_t i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(result.value[static_cast<Eigen::Index>(i)], exact[i], 1e-7 * largest(exact)) << each.formula << i;
    }
  }
}
