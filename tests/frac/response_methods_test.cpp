// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/response_methods.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/exact_output.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/observed_order.hpp"
#include "support/random.hpp"
#include "support/step_systems.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::Hold;
using frac::ReferenceResponse;
using frac::ResponseInput;
using frac::ResponseMethod;
using frac::SampledInput;
using support::expect_invalid_argument;
using Kind = ResponseInput::Kind;

FractionalTransferFunction model(const char* formula) {
  return FractionalTransferFunction::parse(formula);
}

std::vector<double> even_times(double end, std::size_t steps) {
  std::vector<double> time;
  for (std::size_t n = 0; n <= steps; ++n) time.push_back(end * static_cast<double>(n) / static_cast<double>(steps));
  return time;
}

double error_at_end(ResponseMethod method, const char* formula, const ResponseInput& input, double end,
                    std::size_t steps) {
  const auto response = frac::respond(model(formula), input, even_times(end, steps), 1e-6, method);
  return std::abs(response.output.back() - ReferenceResponse(model(formula), input)(end).value);
}

}  // namespace

// A step starts the response with t^e, e = 0.5, 1, .. and the like; the sine is smooth.  The next powers after those
// made exact leave an order that tends to 2 from below.
TEST(Bdf2, ConvergesWithSecondOrder) {
  const ResponseInput sine{Kind::sine, 1.3};
  struct Case {
    const char* formula;
    ResponseInput input;
    double slack;
  };
  for (const auto& [formula, input, slack] : {Case{"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", {}, 0.03},
                                              {"1/(s^0.5 + 1)", {}, 0.1},
                                              {"1/(s^0.8 + 1)", {}, 0.1},
                                              {"1/(s + 1)", {}, 0.03},
                                              {"(1 - s^0.8)/(s^1.6 + s^0.8 + 1)", {}, 0.15},
                                              {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", sine, 0.05},
                                              {"1/(s^0.5 + 1)", sine, 0.1},
                                              {"(s + 2)/(s^1.5 + 1)", sine, 0.15}}) {
    const auto error = [&, &f = formula, &u = input](std::size_t steps) {
      return error_at_end(ResponseMethod::bdf2, f, u, 3, steps);
    };
    EXPECT_NEAR(support::observed_order(error(1000), error(2000)), 2, slack) << formula;
  }
}

TEST(Bdf2, OfAnIntegerPowerOfTheStepIsExact) {
  // 1/s^1.5 answers a step with t^1.5/Gamma(2.5), which the starting weights make exact.
  const std::vector<double> output = frac::respond_bdf2(model("1/s^1.5"), std::vector<double>(50, 1.0), 0.1);
  for (std::size_t n = 0; n < output.size(); ++n) {
    EXPECT_NEAR(output[n], std::pow(0.1 * static_cast<double>(n), 1.5) / std::tgamma(2.5), 1e-12);
  }
}

// The ladder errs by its tolerance in every power of s inside its band, in the response by no more than a few times it.
TEST(Ladder, MeetsItsToleranceUpToTheConditionOfTheModel) {
  for (const char* formula : {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "1/(s^0.5 + 1)", "(s^0.5 + 0.5)/(s + 0.2 s^0.5 + 2)",
                              "1/(s (s^0.5 + 1))", "exp(-0.3 s)/(s^1.2 + 1)"}) {
    const ReferenceResponse exact(model(formula));
    for (const double tolerance : {1e-3, 1e-5}) {
      const std::vector<double> output =
          frac::respond_ladder(model(formula), std::vector<double>(301, 1.0), 0.1, tolerance);
      // At t = 0 itself the gain of the ladder beyond its band shows.
      for (std::size_t n = 1; n < output.size(); n += 13) {
        EXPECT_NEAR(output[n], exact(0.1 * static_cast<double>(n)).value, 20 * tolerance) << formula << " " << n;
      }
    }
  }
}

// Poles that coincide have no modes.  The ladder errs as above, relative to a response that grows.
TEST(Ladder, HoldsWherePolesCoincide) {
  for (const char* formula :
       {"1/s^2", "1/(s + 1)^2", "1/((s + 1)^2 (s^0.5 + 1))", "1/((s^0.5 + 1) (s^2 + 0.2 s + 1)^2)"}) {
    const ReferenceResponse exact(model(formula));
    const std::vector<double> output = frac::respond_ladder(model(formula), std::vector<double>(301, 1.0), 0.1, 1e-6);
    for (std::size_t n = 1; n < output.size(); n += 13) {
      const double value = exact(0.1 * static_cast<double>(n)).value;
      EXPECT_NEAR(output[n], value, 20e-6 * std::max(1.0, std::abs(value))) << formula << " " << n;
    }
  }
}

TEST(Ladder, OfIntegerOrdersIsExact) {
  const std::vector<double> output =
      frac::respond_ladder(model("1/(s^2 + 3 s + 2)"), even_times(3, 30), 0.1, 1e-3, Hold::first_order);
  const ReferenceResponse exact(model("1/(s^2 + 3 s + 2)"), {Kind::ramp});
  for (std::size_t n = 0; n < output.size(); ++n) {
    EXPECT_NEAR(output[n], exact(0.1 * static_cast<double>(n)).value, 1e-14);
  }
}

TEST(RespondByAnyMethod, ChoosesTheCheapestThatMeetsTheTolerance) {
  const auto furnace = model("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const std::vector<double> many = even_times(30, 3000);
  const std::vector<double> few{1, 5};
  EXPECT_EQ(frac::respond(furnace, ResponseInput{}, many).method, ResponseMethod::exponential_sum);
  EXPECT_EQ(frac::respond(furnace, ResponseInput{}, few).method, ResponseMethod::reference);
  EXPECT_EQ(frac::respond(furnace, ResponseInput{}, many, 1e-14).method, ResponseMethod::reference);
  EXPECT_EQ(frac::respond(furnace, ResponseInput{Kind::impulse}, many).method, ResponseMethod::exponential_sum);
  // An infinite start is the reference's alone.
  EXPECT_EQ(frac::respond(model("1/(s^0.5 + 1)"), ResponseInput{Kind::impulse}, many).method,
            ResponseMethod::reference);
}

// After 1600 periods of a double pole on the axis the exponentials, which stand around it, no longer cancel to nine
// digits; the reference takes the pole itself.
TEST(RespondByAnyMethod, TakesTheNextMethodWhereTheCheapestMisses) {
  const auto resonant = model("1/(s^4 + 2 s^2 + 1)");
  const std::vector<double> time = even_times(1e4, 400);
  EXPECT_FALSE(frac::respond(resonant, ResponseInput{}, time, 1e-10, ResponseMethod::exponential_sum).meets_tolerance);
  const auto response = frac::respond(resonant, ResponseInput{}, time, 1e-10);
  EXPECT_EQ(response.method, ResponseMethod::reference);
  EXPECT_TRUE(response.meets_tolerance);
  for (std::size_t n = 0; n < time.size(); ++n) {
    const double t = time[n];
    EXPECT_NEAR(response.output[n], 1 - std::cos(t) - t / 2 * std::sin(t), 1e-10 * 5e3) << t;
  }
  // Coefficients known to rounding split a double pole by 1e-8: no method knows better, and none is tried for long.
  const std::vector<double> dense = even_times(1e4, 20'000);
  EXPECT_FALSE(frac::respond(model("1/(s^4 + 0.6 s^2 + 0.09)"), ResponseInput{}, dense, 1e-10).meets_tolerance);
  // Given as a power it is not split.
  EXPECT_TRUE(frac::respond(model("1/(s^2 + 0.3)^2"), ResponseInput{}, dense, 1e-10).meets_tolerance);
}

// 1/(s - 2) answers a step with (e^{2 t} - 1)/2, which leaves the range of a double at 355 s.
TEST(RespondByAnyMethod, GivesTheInstantsBeforeAnUnstableModelOutgrowsADouble) {
  const FractionalTransferFunction unstable({{1, 0}}, {{1, 1}, {-2, 0}});
  for (const std::size_t count : {2U, 61U}) {
    std::vector<double> time;
    for (std::size_t n = 0; n < count; ++n)
      time.push_back(1 + 900.0 * static_cast<double>(n) / static_cast<double>(count - 1));
    const auto response = respond(unstable, ResponseInput{}, time);
    EXPECT_EQ(response.method, ResponseMethod::reference);
    for (std::size_t n = 0; n < count; ++n) {
      const double exact = std::expm1(2 * time[n]) / 2;
      if (std::isinf(exact)) {
        EXPECT_EQ(response.output[n], exact) << time[n];
      } else {
        EXPECT_NEAR(response.output[n] / exact, 1, 1e-12) << time[n];
      }
    }
    EXPECT_THROW(static_cast<void>(respond(unstable, ResponseInput{}, time, 1e-9, ResponseMethod::exponential_sum)),
                 std::invalid_argument);
  }
}

TEST(RespondByAnyMethod, MeetsTheToleranceForEveryNamedInputAtAnyInstants) {
  const std::vector<double> even = even_times(20, 400);
  std::vector<double> uneven{0};
  for (double t = 1e-4; t < 30; t *= 1.07) uneven.push_back(t);
  for (const char* formula : {"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "exp(-0.3 s)/(s^1.2 + 1)", "1/(s (s^0.5 + 1))",
                              "1/(s^2 + 2 s + 1)", "1/(14994 s^1.31 + 6009.5 s^0.97 + 1.69)"}) {
    for (const ResponseInput input : {ResponseInput{Kind::step}, {Kind::ramp}, {Kind::impulse}, {Kind::sine, 2.3}}) {
      for (const auto& time : {even, uneven}) {
        const auto response = frac::respond(model(formula), input, time, 1e-8);
        const auto exact = frac::reference_response(model(formula), input, time);
        double size = 0;
        double error = 0;
        for (std::size_t i = 0; i < time.size(); ++i) {
          size = std::max(size, std::abs(exact[i].value));
          error = std::max(error, std::abs(response.output[i] - exact[i].value));
        }
        EXPECT_LE(error, 1e-8 * size) << formula << " " << static_cast<int>(input.kind);
        EXPECT_TRUE(response.meets_tolerance) << formula;
      }
    }
  }
}

TEST(RespondByAnyMethod, TakesSamplesAtAnyInstants) {
  support::Random random(3);
  SampledInput input{{0}, {1}};
  while (input.time.size() < 40) {
    input.time.push_back(input.time.back() + random.log_uniform(0.01, 1));
    input.value.push_back(random.normal());
  }
  const auto plant = model("exp(-0.05 s)/(s^1.3 + 0.4 s^0.5 + 1)");
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    input.hold = hold;
    const std::vector<double> exact = support::exact_output(plant, input.time, input.value, hold);
    for (const ResponseMethod method : {ResponseMethod::exponential_sum, ResponseMethod::reference}) {
      const auto response = frac::respond(plant, input, input.time, 1e-9, method);
      for (std::size_t i = 0; i < exact.size(); ++i) EXPECT_NEAR(response.output[i], exact[i], 3e-8) << i;
      EXPECT_LT(response.error_estimate, 1e-8);
    }
  }
}

// Double poles, alone and beside a lag, at any tolerance of a sum that a finer one can be held against: what the
// estimate leaves out is the error of the finer sum between twenty instants, a thousandth of what it is held to.
TEST(RespondByAnyMethod, EstimateForAStepCoversTheErrorAtEveryInstant) {
  support::Random random(390701);
  for (int trial = 0; trial < 24; ++trial) {
    const double order = random.uniform(0.4, 1.6), place = random.log_uniform(0.2, 3);
    std::vector<frac::PowerFactor> below{{{{1, order}, {place, 0}}, 2}};
    if (trial % 3 == 0) below.push_back({{{random.log_uniform(0.1, 3), 1}, {1, 0}}, 1});
    const auto plant = FractionalTransferFunction::from_factors({{{{1, 0}}, 1}}, below);
    const std::vector<double> time = even_times(random.log_uniform(3, 60), 300);
    const auto exact = frac::reference_response(plant, {}, time);
    for (const double tolerance : {1e-2, 1e-4, 1e-7, 1e-10}) {
      for (const ResponseMethod method : {ResponseMethod::exponential_sum, ResponseMethod::bdf2}) {
        if (method == ResponseMethod::bdf2 && tolerance > 1e-4) continue;
        const auto response = frac::respond(plant, ResponseInput{}, time, tolerance, method);
        double worst = 0, uncertain = 0;
        for (std::size_t i = 0; i < time.size(); ++i) {
          worst = std::max(worst, std::abs(response.output[i] - exact[i].value));
          uncertain = std::max(uncertain, exact[i].error_estimate);
        }
        EXPECT_LE(worst, (1 + 1e-3) * response.error_estimate + uncertain) << plant.formula() << " " << tolerance;
        EXPECT_GE(worst, 0.5 * response.error_estimate - 2 * uncertain - 1e-3 * tolerance) << plant.formula();
      }
    }
  }
}

// What an estimate of some twenty differences would leave out between them is in it.
TEST(RespondByAnyMethod, EstimatesTheErrorOfEveryMethod) {
  const auto furnace = model("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const std::vector<double> time = even_times(20, 800);
  const auto exact = frac::reference_response(furnace, {}, time);
  for (const ResponseMethod method : {ResponseMethod::exponential_sum, ResponseMethod::grunwald_letnikov,
                                      ResponseMethod::bdf2, ResponseMethod::ladder}) {
    const auto response = frac::respond(furnace, ResponseInput{}, time, 1e-7, method);
    double error = 0;
    for (std::size_t i = 0; i < time.size(); ++i) {
      error = std::max(error, std::abs(response.output[i] - exact[i].value));
    }
    EXPECT_GE(response.error_estimate, error) << frac::to_string(method);
    EXPECT_LE(response.error_estimate, 1.001 * error + 1e-13) << frac::to_string(method);
    EXPECT_EQ(response.meets_tolerance, method == ResponseMethod::exponential_sum) << frac::to_string(method);
  }
}

// The reference is good to some 1e-13 here, which is granted to it; the estimate is to cover the rest.
TEST(RespondByAnyMethod, EstimateForSamplesCoversTheErrorOfRandomModels) {
  support::Random random(21);
  for (int i = 0; i < 40; ++i) {
    const double high = random.uniform(0.3, 1.8);
    const double low = random.uniform(0.1, 1) * high;
    const FractionalTransferFunction model(
        {{1, 0}}, {{1, high}, {random.uniform(0.2, 2), low}, {random.uniform(0.1, 1), 0}}, i % 4 == 0 ? 0.13 : 0);
    SampledInput input{even_times(4, 30), {}, i % 2 == 0 ? Hold::zero_order : Hold::first_order};
    for (std::size_t n = 0; n < input.time.size(); ++n) input.value.push_back(random.uniform(-1, 1));
    const auto reference = frac::respond(model, input, input.time, 1e-9, ResponseMethod::reference);
    for (const double tolerance : {1e-3, 1e-6, 1e-10}) {
      const auto response = frac::respond(model, input, input.time, tolerance, ResponseMethod::exponential_sum);
      for (std::size_t n = 0; n < input.time.size(); ++n) {
        EXPECT_LE(std::abs(response.output[n] - reference.output[n]),
                  response.error_estimate + reference.error_estimate + 1e-13)
            << model.formula() << " " << tolerance;
      }
    }
  }
}

TEST(RespondByAnyMethod, RefusesWhatMakesNoSense) {
  const auto lag = model("1/(s + 1)");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> uneven{0, 1, 3};
  const auto at = [&](std::vector<double> time) { (void)frac::respond(lag, ResponseInput{}, time); };
  expect_invalid_argument([&] { at({}); }, {"no instants"});
  expect_invalid_argument([&] { at({0, nan}); }, {"time[1] = nan"});
  expect_invalid_argument([&] { at({-1, 2}); }, {"time[0] = -1 s"});
  expect_invalid_argument([&] { at({1, 1}); }, {"time[1] = 1 s does not lie after 1 s"});
  expect_invalid_argument(
      [&] {
        (void)frac::respond(lag, SampledInput{{0, 1}, {1, nan}}, uneven);
      },
      {"samples[1] = nan"});
  expect_invalid_argument(
      [&] {
        (void)frac::respond(lag, SampledInput{{0, 1}, {1}}, uneven);
      },
      {"2 instants but 1 samples"});
  expect_invalid_argument([&] { (void)frac::respond(lag, ResponseInput{}, uneven, 0.5); }, {"tolerance = 0.5"});
  for (const ResponseMethod method :
       {ResponseMethod::grunwald_letnikov, ResponseMethod::bdf2, ResponseMethod::ladder}) {
    expect_invalid_argument([&] { (void)frac::respond(lag, ResponseInput{}, uneven, 1e-6, method); }, {"0, T, 2 T"});
  }
  expect_invalid_argument([] { (void)frac::respond_bdf2(model("1/(s + s^0.9 + 1)"), std::vector<double>(9, 1.0), 1); },
                          {"more than 8 powers"});
  expect_invalid_argument([&] { (void)frac::respond_ladder(lag, uneven, 1, 0.5); }, {"tolerance = 0.5"});
  expect_invalid_argument([] { (void)frac::response_method_from_string("best"); }, {"\"best\"", "bdf2"});
}

TEST(HardCases, IntegerOrdersGiveTheClassicalAnswer) {
  struct Classical {
    const char* formula;
    double (*exact)(double);
  };
  for (const auto& [formula, exact] : {Classical{"1/(s + 1)", [](double t) { return -std::expm1(-t); }},
                                       {"1/(s^2 + 1)", [](double t) { return 1 - std::cos(t); }},
                                       {"1/(s^2 + 2 s + 1)", [](double t) { return 1 - (1 + t) * std::exp(-t); }},
                                       {"(s + 1)/(s^2 + 3 s + 2)", [](double t) { return -std::expm1(-2 * t) / 2; }},
                                       {"(s + 2)/s", [](double t) { return 1 + 2 * t; }}}) {
    const std::vector<double> time = even_times(20, 1000);
    const auto response = frac::respond(model(formula), ResponseInput{}, time, 1e-13, ResponseMethod::exponential_sum);
    double size = 0;
    for (const double t : time) size = std::max(size, std::abs(exact(t)));
    for (std::size_t n = 1; n < time.size(); ++n)
      EXPECT_NEAR(response.output[n], exact(time[n]), 1e-12 * size) << formula;
  }
}

TEST(HardCases, FromANanosecondToABillionSeconds) {
  std::vector<double> time;
  for (double t = 1e-9; t < 1.1e9; t *= 10) time.push_back(t);
  for (const char* formula :
       {"1/(s^0.6 + 10)", "1/(14994 s^1.31 + 6009.5 s^0.97 + 1.69)", "(s^0.5 + 0.5)/(s + 0.2 s^0.5 + 2)",
        "(s + 1)/(s^2 + 3 s + 2.0000001)", "1/(s^2 + 2 s^1.5 + s)"}) {
    const auto response = frac::respond(model(formula), ResponseInput{}, time, 1e-9, ResponseMethod::exponential_sum);
    const auto exact = frac::reference_response(model(formula), {}, time);
    for (std::size_t i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(response.output[i], exact[i].value, 1e-9 * std::abs(exact.back().value)) << formula << " " << time[i];
    }
  }
}

// The pole of 1/(s^0.6 - 0.5) is 0.5^(1/0.6); what else there is has decayed by 1e-50 against it.
TEST(HardCases, UnstableModelsGrowAsTheyMust) {
  const std::vector<double> time = even_times(400, 400);
  const auto response = frac::respond(model("1/(s^0.6 - 0.5)"), ResponseInput{}, time, 1e-9);
  const double pole = std::pow(0.5, 1 / 0.6);
  EXPECT_NEAR(std::log(response.output[400] / response.output[300]) / 100, pole, 1e-9);
  EXPECT_TRUE(response.meets_tolerance);
}

// s^1.5 = 2 at s = 2^(2/3): the response grows as e^(s t) and exceeds a double, e^709.8, after about 709.8/s.  The
// differences of first and second order put 1 - z and 3/2 - 2 z + z^2/2, z = e^(-rate T), in place of s T, and grow at
// that rate.  What stands before the exponential, about 1/4, shifts the instant by a second or so.
TEST(HardCases, OutgrownResponsesAreInfiniteAndNeverNan) {
  const double step = 0.25;
  const double pole = std::cbrt(4.0);
  const std::vector<double> time = even_times(1000, 4000);
  SampledInput samples{time, std::vector<double>(time.size(), 1.0), Hold::zero_order};
  for (const auto method : {ResponseMethod::exponential_sum, ResponseMethod::grunwald_letnikov, ResponseMethod::bdf2,
                            ResponseMethod::ladder}) {
    for (const frac::TimeInput& input : {frac::TimeInput(ResponseInput{}), frac::TimeInput(samples)}) {
      SCOPED_TRACE(std::string(frac::to_string(method)));
      const auto response = frac::respond(model("1/(s^1.5 - 2)"), input, time, 1e-6, method);
      std::size_t infinite = 0;
      for (const double value : response.output) {
        EXPECT_FALSE(std::isnan(value));
        if (std::isinf(value)) ++infinite;
        EXPECT_EQ(std::isinf(value), infinite > 0);
      }
      const double rate = method == ResponseMethod::grunwald_letnikov ? -std::log(1 - pole * step) / step
                          : method == ResponseMethod::bdf2 ? -std::log(2 - std::sqrt(1 + 2 * pole * step)) / step
                                                           : pole;
      EXPECT_NEAR(static_cast<double>(infinite) * step, 1000 - 709.8 / rate, 4);
      EXPECT_EQ(response.output.back(), std::numeric_limits<double>::infinity());
      EXPECT_EQ(response.error_estimate, std::numeric_limits<double>::infinity());
      EXPECT_FALSE(response.meets_tolerance);
    }
  }
}

TEST(HardCases, OneSampleAndStepsOfAPicosecond) {
  const std::vector<double> start{0};
  EXPECT_EQ(frac::respond(model("(2 s^0.5 + 1)/(s^0.5 + 3)"), ResponseInput{}, start).output.at(0), 2);
  const SampledInput one{{5}, {3}};
  const std::vector<double> at{5, 6};
  EXPECT_NEAR(frac::respond(model("1/(s + 1)"), one, at).output.at(1), -3 * std::expm1(-1), 1e-9);
  const std::vector<double> tiny = even_times(1e-9, 1000);
  const auto response = frac::respond(model("1/(s^0.5 + 1)"), ResponseInput{}, tiny, 1e-9);
  const ReferenceResponse exact(model("1/(s^0.5 + 1)"));
  for (const std::size_t n : {1u, 10u, 1000u}) {
    EXPECT_NEAR(response.output[n], exact(tiny[n]).value, 1e-9 * response.output.back());
  }
}
