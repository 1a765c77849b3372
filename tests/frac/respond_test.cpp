// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/respond.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "frac/time_response/reference_response.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/observed_order.hpp"
#include "support/random.hpp"
#include "support/step_systems.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::Hold;
using frac::ReferenceResponse;
using frac::ResponseFilter;
using frac::ResponseInput;
using support::expect_invalid_argument;

std::vector<std::pair<std::string, FractionalTransferFunction>> systems() {
  std::vector<std::pair<std::string, FractionalTransferFunction>> all;
  for (const auto& [name, system] : support::step_systems()) all.emplace_back(name, system.model);
  for (const std::string& model : support::hard_systems()) {
    all.emplace_back(model, FractionalTransferFunction::parse(model));
  }
  return all;
}

// Largest error over largest value, at every early sample and at some later ones.
double relative_error(const std::vector<double>& output, const ReferenceResponse& reference, double sample_time) {
  double error = 0;
  double largest = 0;
  for (std::size_t n = 0; n < output.size(); n = n < 70 ? n + 1 : n + n / 9) {
    const double exact = reference(static_cast<double>(n) * sample_time).value;
    error = std::max(error, std::abs(output[n] - exact));
    largest = std::max(largest, std::abs(exact));
  }
  return error / largest;
}

std::vector<double> ramp(std::size_t count, double sample_time) {
  std::vector<double> samples;
  for (std::size_t n = 0; n < count; ++n) samples.push_back(static_cast<double>(n) * sample_time);
  return samples;
}

// The sum of the input's steps times the exact step response at each lag.
std::vector<double> superposed(const FractionalTransferFunction& model, const std::vector<double>& samples,
                               double sample_time) {
  const ReferenceResponse step(model);
  std::vector<double> response;
  for (std::size_t n = 0; n < samples.size(); ++n) response.push_back(step(static_cast<double>(n) * sample_time).value);
  std::vector<double> output(samples.size(), 0);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    for (std::size_t j = 0; j <= n; ++j) output[n] += (samples[j] - (j > 0 ? samples[j - 1] : 0)) * response[n - j];
  }
  return output;
}

}  // namespace

TEST(Respond, StepResponsesMeetTheTolerance) {
  for (const auto& [name, model] : systems()) {
    const ReferenceResponse reference(model);
    for (const double sample_time : {1e-3, 0.1}) {
      const double end = name == "1/(s^1.2 - 2)" || name == "1/(s^3.5 + 1)" ? 10 : 2000;
      const std::vector<double> samples(static_cast<std::size_t>(end / (100 * sample_time)) + 40, 1.0);
      for (const double tolerance : {1e-3, 1e-6, 1e-9}) {
        const std::vector<double> output = frac::respond(model, samples, sample_time, tolerance);
        EXPECT_LE(relative_error(output, reference, sample_time), tolerance) << name << " " << sample_time;
      }
    }
  }
}

TEST(Respond, LongStepResponsesMeetTheTolerance) {
  const std::vector<double> samples(200'000, 1.0);
  for (const auto& [name, system] : support::step_systems()) {
    for (const double tolerance : {1e-9, 1e-12}) {
      const std::vector<double> output = frac::respond(system.model, samples, 1e-4, tolerance);
      EXPECT_LE(relative_error(output, ReferenceResponse(system.model), 1e-4), tolerance) << name;
    }
  }
}

// A straight line between samples is what the first-order hold takes the ramp for: no interpolation error.
// 1/(s^a + 1) has its pole at arg s = pi/a: before, beside, on and beyond the cut, for steps that put the nodes
// anywhere between the pole's.  What the rule misses of the pole is added, so that none takes more states than the
// next.
TEST(Respond, PolesAboutTheCutNeedNoMoreStates) {
  std::vector<FractionalTransferFunction> models;
  for (const double order : {0.7, 0.9, 0.99, 0.9999, 1.0001, 1.02, 1.2, 1.7}) {
    models.push_back(FractionalTransferFunction({{1, 0}}, {{1, order}, {1, 0}}));
  }
  models.push_back(FractionalTransferFunction::parse("1/(s^1.5 + 2 s + s^0.5 + 2)"));  // (s + 1)(s^0.5 + 2)
  models.push_back(FractionalTransferFunction::parse("(s^0.5 + 3)/(s^2 + 1.01 s + 0.01)"));
  for (const FractionalTransferFunction& model : models) {
    const ReferenceResponse reference(model);
    for (const double sample_time : {1e-3, 1.17e-3, 1.35e-3, 0.05}) {
      const std::vector<double> samples(20'000, 1.0);
      const std::vector<double> output = frac::respond(model, samples, sample_time, 1e-11);
      EXPECT_LE(relative_error(output, reference, sample_time), 1e-11) << model.formula() << " " << sample_time;
      EXPECT_LE(ResponseFilter(model, sample_time, 1e-11, Hold::zero_order, 20'000).states(), 64U);
    }
  }
}

// Residues of 200 that cancel, before, beside and on the cut.
TEST(Respond, PolesCloseTogetherKeepTenDigits) {
  for (const char* text : {"1/((s^1.3 + 1)(s^1.3 + 1.004))", "1/((s^0.99 + 1)(s^0.99 + 1.004))",
                           "1/((s + 1)(s + 1.01)(s^0.5 + 1))", "1/((s^1.005 + 1)(s^0.99 + 1))"}) {
    const auto model = FractionalTransferFunction::parse(text);
    const std::vector<double> samples(20'000, 1.0);
    EXPECT_LE(relative_error(frac::respond(model, samples, 1e-3, 1e-10), ReferenceResponse(model), 1e-3), 1e-10)
        << text;
  }
}

TEST(Respond, RampResponsesOfTheFirstOrderHoldAreExact) {
  for (const auto& [name, model] : systems()) {
    const ReferenceResponse reference(model, {ResponseInput::Kind::ramp});
    const std::vector<double> output = frac::respond(model, ramp(500, 0.02), 0.02, 1e-10, Hold::first_order);
    EXPECT_LE(relative_error(output, reference, 0.02), 1e-10) << name;
  }
}

TEST(Respond, AnyInputIsTheSumOfItsSteps) {
  support::Random random(1);
  std::vector<double> samples;
  for (int n = 0; n < 300; ++n) samples.push_back(n / 40 % 3 == 1 ? 0.7 : random.normal());
  for (const auto& [name, model] : systems()) {
    const std::vector<double> exact = superposed(model, samples, 0.05);
    const std::vector<double> output = frac::respond(model, samples, 0.05, 1e-10);
    double largest = 0;
    for (const double y : exact) largest = std::max(largest, std::abs(y));
    for (std::size_t n = 0; n < samples.size(); ++n) {
      // The steps of the input add up to about 300.
      EXPECT_NEAR(output[n], exact[n], 300e-10 * std::max(1.0, largest)) << name << " " << n;
    }
  }
}

// Linear interpolation of a smooth input errs by T^2/8 of its second derivative.
TEST(Respond, SineBetweenFirstOrderSamplesConvergesWithSecondOrder) {
  const auto model = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const ReferenceResponse reference(model, {ResponseInput::Kind::sine, 1});
  const auto error = [&](double sample_time) {
    std::vector<double> samples;
    for (int n = 0; n * sample_time < 20.0001; ++n) samples.push_back(std::sin(n * sample_time));
    return relative_error(frac::respond(model, samples, sample_time, 1e-12, Hold::first_order), reference, sample_time);
  };
  EXPECT_NEAR(support::observed_order(error(0.1), error(0.05)), 2, 0.02);
}

// (s^0.5 + 1)/s^2.5 and the like: the integrals are carried exactly.
TEST(Respond, IntegratorsAreExact) {
  for (const char* model : {"1/s", "1/s^2", "1/s^3", "1/s^0.5", "1/s^1.3", "1/s^2.6", "(s^0.5 + 1)/s", "(s + 2)/s",
                            "(s^1.5 + s + 1)/(s^2.5 + s^2)", "exp(-0.013 s)/s^1.5"}) {
    const auto transfer = FractionalTransferFunction::parse(model);
    for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
      const std::vector<double> output = frac::respond(transfer, std::vector<double>(3000, 2.0), 0.01, 1e-11, hold);
      double worst = 0;
      double largest = 0;
      const ReferenceResponse reference(transfer);
      for (std::size_t n = 0; n < output.size(); n += 17) {
        const double exact = 2 * reference(0.01 * static_cast<double>(n)).value;
        largest = std::max(largest, std::abs(exact));
        worst = std::max(worst, std::abs(output[n] - exact));
      }
      EXPECT_LE(worst, 1e-11 * largest) << model;
    }
  }
}

// Twice integrated fast terms would be 1e8 times the response here, and cancel.
TEST(Respond, IntegratorsKeepTheirDigitsOverLongHorizons) {
  for (const char* text :
       {"(s^1.5 + 1)/s^2", "(s^0.5 + 1)/s^1.2", "1/(s^2.5 + s^2)", "1/s^2.7", "(s^2 + s^0.3 + 1)/s^2"}) {
    const auto model = FractionalTransferFunction::parse(text);
    for (const double sample_time : {1e-4, 0.1}) {
      const std::vector<double> samples(100'000, 1.0);
      EXPECT_LE(
          relative_error(frac::respond(model, samples, sample_time, 1e-12), ReferenceResponse(model), sample_time),
          1e-12)
          << text << " " << sample_time;
    }
  }
}

// What cancels before the response has risen: 1e-18 of the static gain here.
TEST(Respond, HorizonsThatEndBeforeTheRiseKeepTheirDigits) {
  for (const char* text : {"1/(s^2 + 2 s + 1)", "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", "s^0.5/(s + 1)", "s^0.5/(s^1.2 + 1)",
                           "1/(s^3.5 + 1)", "(1 - s)/(s^1.5 + 1)^2"}) {
    const auto model = FractionalTransferFunction::parse(text);
    const ReferenceResponse step(model);
    const ReferenceResponse slope(model, {ResponseInput::Kind::ramp});
    const std::vector<double> ones(1000, 1.0);
    EXPECT_LE(relative_error(frac::respond(model, ones, 1e-12, 1e-12), step, 1e-12), 1e-12) << text;
    const std::vector<double> line = ramp(1000, 1e-12);
    EXPECT_LE(relative_error(frac::respond(model, line, 1e-12, 1e-12, Hold::first_order), slope, 1e-12), 1e-12) << text;
  }
}

TEST(Respond, DeadTimeIsExactBelowOneSample) {
  for (const double delay : {0.0, 0.003, 0.01, 0.0249999, 0.03, 0.4321}) {
    const FractionalTransferFunction model({{1, 0.4}, {1, 0}}, {{1, 0.8}, {0.3, 0}}, delay);
    const std::vector<double> output = frac::respond(model, std::vector<double>(400, 1.0), 0.01, 1e-10);
    EXPECT_LE(relative_error(output, ReferenceResponse(model), 0.01), 1e-10) << delay;
  }
  const FractionalTransferFunction direct({{1, 0.5}}, {{1, 0.5}, {1, 0}}, 0.0237);
  const std::vector<double> output = frac::respond(direct, std::vector<double>(100, 1.0), 0.01, 1e-10);
  EXPECT_LE(relative_error(output, ReferenceResponse(direct), 0.01), 1e-10);
}

TEST(Respond, OneByOneInBlocksAndAgainIsTheSame) {
  support::Random random(3);
  std::vector<double> samples;
  for (int n = 0; n < 500; ++n) samples.push_back(n > 100 && n < 300 ? 1.5 : random.normal());
  for (const char* text : {"exp(-0.037 s)/(s^1.5 + 1)", "1/(s^0.5 + 1)", "(s^0.5 + 1)/s^1.2",
                           "(s^0.5 + 0.5)/(s + 0.2 s^0.5 + 2)", "1/(s^2.5 + s^2)", "(s + 2)/(s + 1)"}) {
    const auto model = FractionalTransferFunction::parse(text);
    for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
      const std::vector<double> whole = frac::respond(model, samples, 0.01, 1e-9, hold);
      ResponseFilter filter(model, 0.01, 1e-9, hold, 500);
      const ResponseFilter untouched = filter;
      for (int round = 0; round < 2; ++round) {
        std::vector<double> pieces(samples.size());
        std::size_t n = 0;
        for (; n < 77; ++n) pieces[n] = filter.step(samples[n]);
        filter.run(std::span<const double>(samples).subspan(n, 350), std::span<double>(pieces).subspan(n, 350));
        for (n += 350; n < samples.size(); ++n) pieces[n] = filter.step(samples[n]);
        for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_NEAR(pieces[i], whole[i], 1e-12) << text << " " << i;
        std::vector<double> in_place = samples;
        ResponseFilter(model, 0.01, 1e-9, hold, 500).run(in_place, in_place);
        EXPECT_EQ(in_place, whole) << text;
        if (round == 0) {
          filter.reset();
        } else {
          filter = untouched;
          EXPECT_NEAR(filter.step(samples[0]), whole[0], 1e-15);
        }
      }
    }
  }
}

TEST(Respond, SettledStatesGiveTheStaticGainAndThenFallSilent) {
  const auto model = FractionalTransferFunction::parse("3/(s^0.5 + 1)");
  std::vector<double> samples(60'000, 1.0);
  std::fill(samples.begin() + 30'000, samples.end(), 0.0);
  const std::vector<double> output = frac::respond(model, samples, 1e3, 1e-10);
  const ReferenceResponse step(model);
  for (const std::size_t n : {29'999u, 30'001u, 59'999u}) {
    const double exact =
        step(1e3 * static_cast<double>(n)).value - (n < 30'000 ? 0 : step(1e3 * static_cast<double>(n - 30'000)).value);
    EXPECT_NEAR(output[n], exact, 3e-10) << n;
  }
}

TEST(Respond, VeryShortAndVeryLongSteps) {
  const auto model = FractionalTransferFunction::parse("1/(s^0.6 + 1)");
  for (const double sample_time : {1e-12, 1e-6, 1e6}) {
    const std::vector<double> output = frac::respond(model, std::vector<double>(1000, 1.0), sample_time, 1e-10);
    EXPECT_LE(relative_error(output, ReferenceResponse(model), sample_time), 1e-10) << sample_time;
  }
  EXPECT_EQ(frac::respond(model, std::vector<double>{5.0}, 1).at(0), 0);
  EXPECT_EQ(
      frac::respond(FractionalTransferFunction::parse("(2 s^0.5 + 1)/(s^0.5 + 3)"), std::vector<double>{5.0}, 1).at(0),
      10);
}

TEST(RespondGrunwaldLetnikov, ConvergesWithFirstOrder) {
  const auto model = FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const double exact = ReferenceResponse(model)(4).value;
  const auto error = [&](std::size_t steps) {
    const std::vector<double> samples(steps + 1, 1.0);
    return std::abs(frac::respond_grunwald_letnikov(model, samples, 4.0 / static_cast<double>(steps)).back() - exact);
  };
  EXPECT_NEAR(support::observed_order(error(400), error(800)), 1, 0.03);
  const auto late = FractionalTransferFunction::parse("exp(-1 s)/(s^0.5 + 1)");
  const std::vector<double> output = frac::respond_grunwald_letnikov(late, std::vector<double>(20, 1.0), 0.1);
  EXPECT_EQ(output[9], 0);
  EXPECT_GT(output[10], 0);
}

TEST(Respond, RefusesWhatItCannotSimulate) {
  const auto model = FractionalTransferFunction::parse("1/(s^0.5 + 1)");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> samples{1, 2, nan};
  const std::vector<double> good{1, 2};
  expect_invalid_argument([&] { (void)frac::respond(model, samples, 1); }, {"samples[2] = nan"});
  expect_invalid_argument([&] { (void)frac::respond(model, {}, 1); }, {"no samples"});
  expect_invalid_argument([&] { (void)frac::respond(model, good, 0); }, {"sample_time = 0"});
  expect_invalid_argument([&] { (void)frac::respond(model, good, 1, 1e-16); }, {"tolerance = 1e-16"});
  expect_invalid_argument([&] { (void)frac::respond(FractionalTransferFunction::parse("s^0.5"), good, 1); },
                          {"s^0.5", "proper"});
  expect_invalid_argument([&] { (void)frac::respond(FractionalTransferFunction::parse("1/s^9"), good, 1); },
                          {"9 integrators"});
  expect_invalid_argument([&] { ResponseFilter(model, 1, 1e-9, Hold::zero_order, 0); }, {"horizon = 0"});
  expect_invalid_argument([&] { (void)frac::respond_grunwald_letnikov(model, samples, 1); }, {"samples[2] = nan"});
  std::vector<double> room(1);
  ResponseFilter filter(model, 1);
  expect_invalid_argument([&] { filter.run(good, room); }, {"2 samples", "1 values"});
}
