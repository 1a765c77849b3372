// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "frac/identification/time_fit.hpp"
#include "frac/model/algebra.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/periodic_records.hpp"

namespace {

using frac::FitResult;
using frac::Hold;
using frac::Structure;
using frac::TimeFitOptions;
using frac::TimeResponseData;
using support::PeriodicExperiment;

double value_of(const FitResult& result, const std::string& name) {
  for (const auto& each : result.parameters)
    if (each.name == name) return each.value;
  throw std::runtime_error("no parameter " + name);
}

bool advises(const FitResult& result, frac::Remedy remedy) {
  return std::any_of(result.advice.begin(), result.advice.end(),
                     [&](const frac::Advice& each) { return each.remedy == remedy; });
}

// Exact records: lines are found to some 1e-13, and the condition of the parameters is below 1e4.
constexpr double to_rounding = 1e-9;

PeriodicExperiment exact_scene(double samples_per_period, double periods) {
  PeriodicExperiment scene;
  scene.formula = "K exp(-L s)/(T s^a + 1)";
  scene.parameters = {2, 0.08, 1.5, 0.7};
  scene.samples_per_period = samples_per_period;
  scene.periods = periods;
  scene.noise = 0;
  return scene;
}

void expect_parameters(const FitResult& result, const PeriodicExperiment& scene) {
  EXPECT_EQ(result.termination, frac::FitTermination::converged) << result.message;
  const Structure structure(scene.formula);
  for (std::size_t i = 0; i < scene.parameters.size(); ++i) {
    const std::string& name = structure.parameter_names()[i];
    EXPECT_NEAR(value_of(result, name), scene.parameters[i], to_rounding) << name;
  }
  EXPECT_NEAR(value_of(result, "offset"), scene.offset, to_rounding);
}

TEST(PeriodicRecord, IsFittedExactlyFromFewSamplesPerPeriod) {
  for (const auto& [samples, periods] : {std::pair{2.2, 2.0}, {2.2, 2.7}, {3.0, 1.0}, {5.0, 3.0}, {20.0, 1.0}}) {
    support::Random random(1);
    const PeriodicExperiment scene = exact_scene(samples, periods);
    const TimeResponseData data = support::periodic_record(scene, Hold::band_limited, random);
    const FitResult result = frac::fit(data, Structure(scene.formula));
    SCOPED_TRACE(std::to_string(samples) + " samples, " + std::to_string(periods) + " periods");
    expect_parameters(result, scene);
    EXPECT_NE(result.message.find(periods >= 2 ? "repeats itself every" : "counts as one period"), std::string::npos)
        << result.message;
  }
}

// The free response of a lag is one exponential, which a step before the record and the offset span exactly.
TEST(PeriodicRecord, ATransientIsThatOfAnEarlierInput) {
  PeriodicExperiment scene;
  scene.formula = "K/(T s + 1)";
  scene.parameters = {2, 1.5};
  scene.noise = 0;
  scene.from_rest = true;
  scene.samples_per_period = 3;
  support::Random random(3);
  const TimeResponseData data = support::periodic_record(scene, Hold::band_limited, random);
  TimeFitOptions options;
  options.earlier_input = true;
  const FitResult result = frac::fit(data, Structure(scene.formula), options);
  // The simulation from rest is good to 1e-10 of the output.
  EXPECT_NEAR(value_of(result, "K"), 2, 1e-7);
  EXPECT_NEAR(value_of(result, "T"), 1.5, 1e-7);
  const FitResult plain = frac::fit(data, Structure(scene.formula));
  EXPECT_TRUE(advises(plain, frac::Remedy::estimate_earlier_input)) << plain.message;
}

TEST(PeriodicRecord, OutputsThatAreLeftOutDoNotCount) {
  const PeriodicExperiment scene = exact_scene(3, 3);
  support::Random random(4);
  const TimeResponseData data = support::periodic_record(scene, Hold::band_limited, random);
  std::vector<std::size_t> later;
  std::vector<double> output = data.output();
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (i < data.size() / 2) {
      output[i] += 50;
    } else {
      later.push_back(i);
    }
  }
  const TimeResponseData changed(data.time(), data.input(), output, {}, Hold::band_limited);
  expect_parameters(frac::fit(changed.observed_at(later), Structure(scene.formula)), scene);
}

TEST(PeriodicRecord, AnIntegratingModelIsFittedBesideADrift) {
  PeriodicExperiment scene;
  scene.formula = "K/(s (T s + 1))";
  scene.parameters = {2, 0.2};
  scene.noise = 0;
  scene.samples_per_period = 4;
  support::Random random(5);
  const TimeResponseData exact = support::periodic_record(scene, Hold::band_limited, random);
  std::vector<double> output = exact.output();
  for (std::size_t i = 0; i < output.size(); ++i) output[i] += 0.7 * exact.time()[i];
  const TimeResponseData data(exact.time(), exact.input(), output, {}, Hold::band_limited);
  TimeFitOptions options;
  options.trend = true;
  const FitResult result = frac::fit(data, Structure(scene.formula), options);
  EXPECT_NEAR(value_of(result, "K"), 2, to_rounding);
  EXPECT_NEAR(value_of(result, "T"), 0.2, to_rounding);
  EXPECT_NEAR(value_of(result, "drift"), 0.7, to_rounding);
}

// Rates by the benchmark periodic_records; here one record of each kind, with noise of one per cent.
TEST(PeriodicRecord, SaysWhereTheHoldCannotBeRight) {
  PeriodicExperiment scene;
  scene.samples_per_period = 3;
  support::Random random(6);
  const TimeResponseData data = support::periodic_record(scene, Hold::band_limited, random);
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    const FitResult wrong = frac::fit(support::with_hold(data, hold), Structure(scene.formula));
    EXPECT_TRUE(advises(wrong, frac::Remedy::hold_band_limited)) << wrong.message;
    EXPECT_NE(wrong.message.find("cannot be right"), std::string::npos);
  }
  const FitResult right = frac::fit(data, Structure(scene.formula));
  EXPECT_EQ(right.message.find("cannot be right"), std::string::npos) << right.message;
}

TEST(PeriodicRecord, RefusesUnevenStepsAndAnInputThatStands) {
  support::expect_invalid_argument(
      [] {
        return TimeResponseData({0, 1, 3}, {1, 2, 1}, {0, 1, 0}, {}, Hold::band_limited);
      },
      {"time[1]", "even"});
  support::expect_invalid_argument(
      [] {
        return TimeResponseData({0, 1, 2}, {1, 1, 1}, {0, 1, 0}, {}, Hold::band_limited);
      },
      {"does not change"});
}

}  // namespace
