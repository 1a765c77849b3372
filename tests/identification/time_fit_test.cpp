// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/time_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "frac/identification/lack_of_fit.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/identification/uncertainty.hpp"
#include "support/exact_output.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/periodic_records.hpp"
#include "support/random.hpp"
#include "support/time_cramer_rao.hpp"

namespace {

using frac::FitResult;
using frac::FractionalTransferFunction;
using frac::Hold;
using frac::Structure;
using frac::TimeFitOptions;
using frac::TimeResponseData;
using support::expect_invalid_argument;

const Structure& furnace_structure() {
  static const Structure structure("1/(a2 s^q2 + a1 s^q1 + 1)");
  return structure;
}

std::vector<double> even_times(double end, std::size_t count) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) time.push_back(end * static_cast<double>(i) / static_cast<double>(count - 1));
  return time;
}

TimeResponseData data_of(const char* model, const std::vector<double>& time, const std::vector<double>& input,
                         Hold hold = Hold::zero_order, double offset = 0) {
  std::vector<double> output = support::exact_output(FractionalTransferFunction::parse(model), time, input, hold);
  for (double& value : output) value += offset;
  return {time, input, output, {}, hold};
}

TimeResponseData furnace_step() {
  const std::vector<double> time = even_times(15, 301);
  return data_of("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)", time, std::vector<double>(time.size(), 1.0));
}

const frac::ParameterEstimate& estimate(const FitResult& result, const std::string& name) {
  for (const auto& each : result.parameters) {
    if (each.name == name) return each;
  }
  throw std::runtime_error("no parameter " + name);
}

void expect_values(const FitResult& result, const std::vector<std::pair<const char*, double>>& exact,
                   double tolerance) {
  EXPECT_EQ(result.termination, frac::FitTermination::converged) << result.message;
  for (const auto& [name, value] : exact) EXPECT_NEAR(estimate(result, name).value, value, tolerance) << name;
}

// Exact samples to 15 digits; the scaled Fisher condition is about 500, so that rounding of 1e-15 leaves 1e-13.
constexpr double to_rounding = 1e-11;

}  // namespace

// K and the offset are linear: what they are in noise of correlation r^|i - j| between samples i and j is written out,
// (X' C^-1 X)^-1 X' C^-1 y, also where samples are missing.
TEST(TimeFit, InNoiseOfAToldCorrelationIsGeneralisedLeastSquares) {
  constexpr double r = 0.8;
  const std::vector<double> time = even_times(10, 101);
  support::Random random(5);
  std::vector<double> input;
  for (std::size_t i = 0; i < time.size(); ++i) input.push_back(i % 10 == 0 ? random.normal() : input.back());
  const std::vector<double> unit =
      support::exact_output(FractionalTransferFunction::parse("1/(1.5 s + 1)"), time, input, Hold::zero_order);
  std::vector<double> output = unit;
  const std::vector<double> noise = support::first_order_noise(time.size(), r, random);
  for (std::size_t i = 0; i < output.size(); ++i) output[i] = 2 * output[i] + 0.3 + 0.05 * noise[i];
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < time.size(); ++i)
    if (i % 7 != 3) index.push_back(i);

  const auto count = static_cast<Eigen::Index>(index.size());
  Eigen::MatrixXd columns(count, 2), covariance(count, count);
  Eigen::VectorXd values(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t at = index[static_cast<std::size_t>(i)];
    columns.row(i) << unit[at], 1;
    values[i] = output[at];
    for (Eigen::Index j = 0; j < count; ++j)
      covariance(i, j) =
          std::pow(r, std::abs(static_cast<double>(at) - static_cast<double>(index[static_cast<std::size_t>(j)])));
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
  const Eigen::MatrixXd inverse = (columns.transpose() * factor.solve(columns)).inverse();
  const Eigen::VectorXd best = inverse * (columns.transpose() * factor.solve(values));
  const Eigen::VectorXd rest = values - columns * best;
  const double cost = rest.dot(factor.solve(rest));

  TimeFitOptions options;
  options.noise_correlation = r;
  const TimeResponseData data = TimeResponseData(time, input, output).observed_at(index);
  // The solve ends with a step that changes the cost by less than 1e-14 of it, which is sqrt(1e-14 n) = 1e-6 of a
  // standard error.
  constexpr double tolerance = 3e-6;
  for (const bool offset_is_told : {false, true}) {
    if (offset_is_told) options.offset = best[1];
    const FitResult result = frac::fit(data, Structure("K/(1.5 s + 1)"), options);
    const double degrees = static_cast<double>(count) - (offset_is_told ? 1 : 2);
    const double variance =
        cost / degrees * (offset_is_told ? 1 / columns.col(0).dot(factor.solve(columns.col(0))) : inverse(0, 0));
    const frac::ParameterEstimate gain = estimate(result, "K");
    EXPECT_NEAR(result.cost, cost, tolerance * cost);
    EXPECT_NEAR(gain.value, best[0], tolerance * std::sqrt(variance));
    EXPECT_NEAR(gain.standard_error, gain.widening * std::sqrt(variance), tolerance * std::sqrt(variance));
    EXPECT_EQ(result.noise_correlation, r);
    EXPECT_TRUE(frac::lack_of_fit(data, options, result).adequate);
  }
  for (const double none : {-0.1, 1.0, std::nan("")}) {
    options.noise_correlation = none;
    expect_invalid_argument([&] { static_cast<void>(frac::fit(data, Structure("K/(1.5 s + 1)"), options)); },
                            {"noise_correlation"});
  }
}

// A gain and an offset in noise of first order: with C = r^|i - j| the restricted likelihood of r is
// -(n - 2) ln(e' C^-1 e)/2 - ln|X' C^-1 X|/2 - (n - 1) ln(1 - r^2)/2, and is written out.
TEST(TimeFit, InColouredNoiseTheCorrelationIsTheMostLikelyBesideTheParameters) {
  constexpr double r = 0.8;
  const std::vector<double> time = even_times(20, 201);
  const auto n = static_cast<Eigen::Index>(time.size());
  support::Random random(6);
  std::vector<double> input;
  for (std::size_t i = 0; i < time.size(); ++i) input.push_back(i % 10 == 0 ? random.normal() : input.back());
  const std::vector<double> unit =
      support::exact_output(FractionalTransferFunction::parse("1/(1.5 s + 1)"), time, input, Hold::zero_order);
  std::vector<double> output = unit;
  const std::vector<double> noise = support::first_order_noise(time.size(), r, random);
  for (std::size_t i = 0; i < output.size(); ++i) output[i] = 2 * output[i] + 0.3 + 0.05 * noise[i];
  const auto likelihood = [&](double correlation) {
    Eigen::MatrixXd columns(n, 2), covariance(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      columns.row(i) << unit[static_cast<std::size_t>(i)], 1;
      for (Eigen::Index j = 0; j < n; ++j)
        covariance(i, j) = std::pow(correlation, std::abs(static_cast<double>(i - j)));
    }
    const Eigen::Map<const Eigen::VectorXd> values(output.data(), n);
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    const Eigen::MatrixXd information = columns.transpose() * factor.solve(columns);
    const Eigen::VectorXd rest =
        values - columns * information.ldlt().solve(columns.transpose() * factor.solve(values));
    const auto count = static_cast<double>(n);
    return -0.5 * (count - 2) * std::log(rest.dot(factor.solve(rest))) - 0.5 * std::log(information.determinant()) -
           0.5 * (count - 1) * std::log(1 - correlation * correlation);
  };
  double best_z = 0, most = likelihood(0);
  for (double z = 0.5; z < 1.8; z += 0.01) {
    if (const double here = likelihood(std::tanh(z)); here > most) std::tie(best_z, most) = std::pair(z, here);
  }

  const TimeResponseData data(time, input, output);
  const Structure structure("K/(1.5 s + 1)");
  TimeFitOptions coloured, told;
  coloured.noise = frac::RecordNoise::coloured;
  const FitResult result = frac::fit(data, structure, coloured);
  // The likelihood peaks with the width 1/sqrt(n) in atanh r, and is looked at in steps of a third of that; the model
  // is linear, so that one round is all.
  EXPECT_NEAR(std::atanh(result.noise_correlation), best_z, (1.0 / 6 + 0.07) / std::sqrt(static_cast<double>(n)));
  EXPECT_NEAR(std::atanh(result.noise_correlation), std::atanh(r), 3 / std::sqrt(static_cast<double>(n)));

  told.noise_correlation = result.noise_correlation;
  const FitResult same = frac::fit(data, structure, told);
  EXPECT_EQ(result.cost, same.cost);
  EXPECT_EQ(estimate(result, "K").ci95_upper, estimate(same, "K").ci95_upper);
  EXPECT_TRUE(frac::lack_of_fit(data, coloured, result).adequate);
  EXPECT_EQ(frac::cross_validation(data, structure, coloured, 5), frac::cross_validation(data, structure, told, 5));
  // 400 refits know a standard deviation to 1/sqrt(800) = 3.5 %, and 200 innovations the size of the noise to 5 %.
  const auto intervals = frac::bootstrap(data, coloured, result, 400);
  EXPECT_NEAR(intervals[0].standard_error / estimate(result, "K").standard_error * estimate(result, "K").widening, 1,
              3 * std::hypot(0.035, 0.05));
}

// White residuals of n samples show a correlation of a few times 1/sqrt(n), which moves no parameter by more than a
// share of its error.
TEST(TimeFit, WhiteNoiseIsNotTakenForColoured) {
  const std::vector<double> time = even_times(15, 301);
  support::Random random(8);
  std::vector<double> input;
  for (std::size_t i = 0; i < time.size(); ++i) input.push_back(i % 20 == 0 ? random.normal() : input.back());
  std::vector<double> output =
      support::exact_output(FractionalTransferFunction::parse("2/(1.5 s^0.7 + 1)"), time, input, Hold::zero_order);
  for (double& each : output) each += 0.02 * random.normal();
  const TimeResponseData data(time, input, output);
  const Structure structure("K/(T s^a + 1)");
  TimeFitOptions options;
  const FitResult white = frac::fit(data, structure, options);
  options.noise = frac::RecordNoise::coloured;
  const FitResult coloured = frac::fit(data, structure, options);
  EXPECT_LT(coloured.noise_correlation, 3 / std::sqrt(301.0));
  for (const char* name : {"K", "T", "a"}) {
    EXPECT_NEAR(estimate(coloured, name).value, estimate(white, name).value,
                0.3 * estimate(white, name).standard_error);
  }
  EXPECT_EQ(frac::record_noise_from_string("coloured"), frac::RecordNoise::coloured);
  expect_invalid_argument([] { static_cast<void>(frac::record_noise_from_string("pink")); },
                          {"pink", "white", "coloured"});
}

TEST(TimeFit, OrdersOfTheFurnaceComeBackFromAnIntegerStart) {
  TimeFitOptions options;
  options.constraints = {
      {"a2", {}, {}, {}, 1.0}, {"q2", {}, {}, {}, 2.0}, {"a1", {}, {}, {}, 1.0}, {"q1", {}, {}, {}, 1.0}};
  for (const bool global : {false, true}) {
    options.global_start = global;
    const FitResult result = frac::fit(furnace_step(), furnace_structure(), options);
    expect_values(result, {{"a2", 0.8}, {"q2", 2.2}, {"a1", 0.5}, {"q1", 0.9}, {"offset", 0}}, to_rounding);
  }
}

// Equal groups of parameters are told apart by their numbers: the higher order goes to q2.
TEST(TimeFit, OrdersOfTheFurnaceComeBackWithoutAStart) {
  const FitResult result = frac::fit(furnace_step(), furnace_structure());
  expect_values(result, {{"a2", 0.8}, {"q2", 2.2}, {"a1", 0.5}, {"q1", 0.9}, {"offset", 0}}, to_rounding);
  EXPECT_EQ(result.free_parameters, 5u);
  EXPECT_EQ(result.residuals, 301u);
}

TEST(TimeFit, EqualTermsAreNamedAlikeWhateverTheSeed) {
  std::vector<double> first;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    TimeFitOptions options;
    options.seed = seed;
    const FitResult result = frac::fit(furnace_step(), Structure("1/(T s^a + D s^b + 1)"), options);
    std::vector<double> values;
    for (const auto& each : result.parameters) values.push_back(each.value);
    if (first.empty()) first = values;
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], first[i], to_rounding) << seed;
  }
}

TEST(TimeFit, DeadTimeOffsetAndUnevenSamplesOfASwitchedInput) {
  support::Random random(4);
  std::vector<double> time{0}, input{1};
  while (time.size() < 300) {
    time.push_back(time.back() + random.uniform(0.01, 0.15));
    input.push_back(random.unit() < 0.15 ? random.normal() : input.back());
  }
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    const TimeResponseData data = data_of("exp(-0.337 s)*2/(1.5 s^0.6 + 1)", time, input, hold, -7);
    const FitResult result = frac::fit(data, Structure("K exp(-L s)/(T s^a + 1)"));
    expect_values(result, {{"K", 2}, {"L", 0.337}, {"T", 1.5}, {"a", 0.6}, {"offset", -7}}, 1e-10);
    const std::vector<double> output = frac::fitted_output(result, data);
    for (std::size_t i = 0; i < output.size(); ++i) EXPECT_NEAR(output[i], data.output()[i], 1e-10);
  }
}

TEST(TimeFit, IntegratorsUnstableModelsAndFeedthrough) {
  const std::vector<double> time = even_times(10, 201);
  const std::vector<double> step(time.size(), 1.0);
  expect_values(frac::fit(data_of("0.7/(s (1.2 s^0.8 + 1))", time, step), Structure("K/(s (T s^a + 1))")),
                {{"K", 0.7}, {"T", 1.2}, {"a", 0.8}}, 1e-10);
  TimeFitOptions either_sign;
  either_sign.constraints = {{"c", {}, -10.0, 10.0, {}}};
  // The response grows to 30, its condition to 1e7.
  expect_values(frac::fit(data_of("1/(s^1.2 - 0.3)", time, step), Structure("K/(s^a + c)"), either_sign),
                {{"K", 1}, {"a", 1.2}, {"c", -0.3}}, 1e-8);
  expect_values(frac::fit(data_of("(2 s^0.5 + 1)/(s^0.5 + 3)", time, step), Structure("(b s^a + 1)/(s^a + c)")),
                {{"b", 2}, {"a", 0.5}, {"c", 3}}, 1e-9);
}

// The rms error of 400 independent trials is known to 1/sqrt(800) = 3.5 %, and the share of 95 % intervals that hold
// the truth to sqrt(0.05 0.95/400) = 1.1 %: three times that each way.
TEST(TimeFit, EstimatesReachTheCramerRaoBoundAndIntervalsCoverTheTruth) {
  const TimeResponseData exact = furnace_step();
  const std::vector<double> truth{0.8, 2.2, 0.5, 0.9};
  constexpr double sigma = 0.01;
  const Eigen::MatrixXd bound =
      support::time_cramer_rao(furnace_structure(), truth, sigma, exact.time(), exact.input(), Hold::zero_order);
  TimeFitOptions options;
  options.global_start = false;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    options.constraints.push_back({furnace_structure().parameter_names()[i], {}, {}, {}, truth[i]});
  }
  support::Random random(11);
  std::vector<double> squares(truth.size() + 1, 0.0);
  std::vector<int> covered(truth.size() + 1, 0);
  constexpr int trials = 400;
  for (int trial = 0; trial < trials; ++trial) {
    std::vector<double> output = exact.output();
    for (double& value : output) value += 3 + sigma * random.normal();
    const FitResult result =
        frac::fit(TimeResponseData(exact.time(), exact.input(), output), furnace_structure(), options);
    for (std::size_t i = 0; i < squares.size(); ++i) {
      const auto& found = result.parameters[i];
      const double error = found.value - (i < truth.size() ? truth[i] : 3);
      squares[i] += error * error;
      covered[i] += std::abs(error) <= found.ci95_upper - found.value ? 1 : 0;
    }
  }
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(std::sqrt(squares[i] / trials / bound(k, k)), 1, 0.105) << i;
    EXPECT_NEAR(covered[i] / static_cast<double>(trials), 0.95, 0.033) << i;
  }
}

TEST(TimeFit, NoiseDoesNotHideTheOptimumFromTheSearch) {
  const TimeResponseData exact = furnace_step();
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    support::Random random(seed);
    std::vector<double> output = exact.output();
    for (double& value : output) value += 0.02 * random.normal();
    const TimeResponseData data(exact.time(), exact.input(), output);
    TimeFitOptions local;
    local.global_start = false;
    local.constraints = {
        {"a2", {}, {}, {}, 0.8}, {"q2", {}, {}, {}, 2.2}, {"a1", {}, {}, {}, 0.5}, {"q1", {}, {}, {}, 0.9}};
    const double from_truth = frac::fit(data, furnace_structure(), local).cost;
    EXPECT_LE(frac::fit(data, furnace_structure()).cost, from_truth * (1 + 1e-9));
  }
}

// Samples that are wrong by 1 do no harm where their sigma says 1e6 times that of the others.
TEST(TimeFit, SigmaSaysWhichSamplesCount) {
  const TimeResponseData exact = furnace_step();
  std::vector<double> output = exact.output(), sigma(exact.size(), 1e-6);
  for (std::size_t i = 5; i < output.size(); i += 10) {
    output[i] += 1;
    sigma[i] = 1;
  }
  const FitResult result = frac::fit(TimeResponseData(exact.time(), exact.input(), output, sigma), furnace_structure());
  // Weights 1e-12 times 30 of 300 samples: a shift by some 1e-13.
  expect_values(result, {{"a2", 0.8}, {"q2", 2.2}, {"a1", 0.5}, {"q1", 0.9}}, to_rounding);
}

TEST(TimeFit, TheInputMayHaveRestedAtAnyValue) {
  const TimeResponseData exact = furnace_step();
  std::vector<double> input = exact.input(), output = exact.output();
  for (double& value : input) value += 4;
  for (double& value : output) value += 4;  // static gain 1
  const FitResult result =
      frac::fit(TimeResponseData(exact.time(), input, output, {}, Hold::zero_order, 4), furnace_structure());
  expect_values(result, {{"q2", 2.2}, {"q1", 0.9}, {"offset", 4}}, to_rounding);
  TimeFitOptions fixed;
  fixed.offset = 4;
  const FitResult held =
      frac::fit(TimeResponseData(exact.time(), input, output, {}, Hold::zero_order, 4), furnace_structure(), fixed);
  expect_values(held, {{"q2", 2.2}, {"q1", 0.9}}, to_rounding);
  EXPECT_EQ(held.parameters.size(), 4u);
}

TEST(TimeFit, ManySamplesAreFittedInFull) {
  const std::vector<double> time = even_times(20, 5000);
  std::vector<double> input;
  for (const double t : time) input.push_back(std::fmod(t, 4) < 2 ? 1 : -1);
  const auto model = FractionalTransferFunction::parse("2/(1.5 s^0.6 + 1)");
  std::vector<double> output = frac::respond(model, input, time[1], 1e-13);
  const FitResult result = frac::fit(TimeResponseData(time, input, output), Structure("K/(T s^a + 1)"));
  EXPECT_EQ(result.residuals, 5000u);
  expect_values(result, {{"K", 2}, {"T", 1.5}, {"a", 0.6}}, 1e-9);
}

/// Output of a layer with its far side held, 0.3 + 2 tanh(sqrt(4 s))/sqrt(4 s), behind an input held between samples:
/// the sum of its responses to steps, 2.3 - 4 sum of e^(-(k + 1/2)^2 pi^2 t/4)/((k + 1/2)^2 pi^2).
TimeResponseData diffusion_record(double noise, support::Random& random) {
  const std::vector<double> time = even_times(20, 201);
  std::vector<double> input, output(time.size(), 0.7);
  for (std::size_t i = 0; i < time.size(); ++i) input.push_back(i % 20 == 0 ? random.normal() : input.back());
  const auto step = [](double t) {
    double sum = 2.3;
    for (int k = 0; k < 400; ++k) {
      const double root = (k + 0.5) * std::numbers::pi;
      sum -= 4 / (root * root) * std::exp(-root * root * t / 4);
    }
    return sum;
  };
  for (std::size_t i = 0; i < time.size(); ++i) {
    double before = 0;
    for (std::size_t n = 0; n < i; n += 20) {
      output[i] += (input[n] - before) * step(time[i] - time[n]);
      before = input[n];
    }
    if (i % 20 == 0) output[i] += 0.3 * (input[i] - before);
    output[i] += noise * random.normal();
  }
  return {time, input, output, {}, Hold::zero_order};
}

TEST(TimeFit, DiffusionWhichIsNoRatioComesBack) {
  const Structure layer("R0 + R1 tanh(sqrt(T s))/sqrt(T s)");
  support::Random random(12);
  const TimeResponseData exact = diffusion_record(0, random);
  const FitResult found = frac::fit(exact, layer);
  expect_values(found, {{"R0", 0.3}, {"R1", 2}, {"T", 4}, {"offset", 0.7}}, 1e-9);
  EXPECT_LT(found.relative_rms, 1e-12);
  const std::vector<double> output = frac::fitted_output(found, exact);
  for (std::size_t i = 0; i < output.size(); ++i) EXPECT_NEAR(output[i], exact.output()[i], 1e-11);
  // Of 4 intervals in each of 30 trials 6 are missed on average, more than 14 with a chance below 1e-3.
  int missed = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const FitResult noisy = frac::fit(diffusion_record(0.02, random), layer);
    for (const auto& [name, value] : std::map<std::string, double>{{"R0", 0.3}, {"R1", 2}, {"T", 4}, {"offset", 0.7}}) {
      const auto& each = estimate(noisy, name);
      EXPECT_TRUE(each.identified) << name;
      missed += each.ci95_lower <= value && value <= each.ci95_upper ? 0 : 1;
    }
  }
  EXPECT_LE(missed, 14);
}

TEST(TimeFit, WhatCannotBeFittedIsSaid) {
  const TimeResponseData data = furnace_step();
  expect_invalid_argument([&] { (void)frac::fit(data, Structure("K exp(-L s)/(1 + T s)^b")); },
                          {"(1 + T s)^b", "poles known to lie on the negative real axis"});
  expect_invalid_argument([&] { (void)frac::fit(data, Structure("K tanh(T s)")); }, {"tanh(T s)"});
  expect_invalid_argument([&] { (void)frac::fit(data, Structure("offset/(s + 1)")); }, {"'offset'"});
  TimeFitOptions local;
  local.global_start = false;
  expect_invalid_argument([&] { (void)frac::fit(data, furnace_structure(), local); }, {"'a2'", "no start value"});
  const TimeResponseData few({0, 1, 2}, {1, 1, 1}, {0, 1, 2});
  expect_invalid_argument([&] { (void)frac::fit(few, furnace_structure()); }, {"3 samples", "5 free"});
  const FitResult improper = frac::fit(data, Structure("K s"));
  EXPECT_EQ(improper.termination, frac::FitTermination::no_usable_start);
  EXPECT_TRUE(std::isnan(improper.cost));
}

// The same record in other units: parameters change by the powers of the units their dimensions say.
TEST(TimeFit, UnitsOfMicrosecondsYearsAndAnySizeAreNoMatter) {
  const TimeResponseData exact = furnace_step();
  const Structure structure("K/(a2 s^q2 + a1 s^q1 + 1)");
  for (const auto& [second, in, out, base] : {std::tuple{1e-6, 1e-18, 1e18, 3e18}, {3e7, 1e18, 1e-18, 0.0}}) {
    std::vector<double> time = exact.time(), input = exact.input(), output = exact.output();
    for (double& value : time) value *= second;
    for (double& value : input) value *= in;
    for (double& value : output) value = value * out + base;
    const FitResult result = frac::fit(TimeResponseData(time, input, output), structure);
    EXPECT_EQ(result.termination, frac::FitTermination::converged);
    // An offset three times the signal costs a digit.
    EXPECT_NEAR(estimate(result, "K").value * in / out, 1, 1e-10);
    EXPECT_NEAR(estimate(result, "q2").value, 2.2, 1e-10);
    EXPECT_NEAR(estimate(result, "q1").value, 0.9, 1e-10);
    EXPECT_NEAR(estimate(result, "a2").value / (0.8 * std::pow(second, 2.2)), 1, 1e-8);
    EXPECT_NEAR(estimate(result, "offset").value / out, base / out, 1e-10);
  }
}

// An offset of 1e6 times the signal leaves ten digits of it.
TEST(TimeFit, AnOffsetMayBeLargeBesideTheSignal) {
  const TimeResponseData exact = furnace_step();
  std::vector<double> output = exact.output();
  for (double& value : output) value += 1e6;
  const FitResult result = frac::fit(TimeResponseData(exact.time(), exact.input(), output), furnace_structure());
  expect_values(result, {{"q2", 2.2}, {"q1", 0.9}}, 1e-7);
  EXPECT_NEAR(estimate(result, "offset").value, 1e6, 1e-8);
}

TEST(TimeFit, ADeadTimeBeyondTheRecordIsSaid) {
  TimeFitOptions options;
  options.constraints = {{"L", 20.0, {}, {}, {}}};
  const FitResult result = frac::fit(furnace_step(), Structure("K exp(-L s)/(T s + 1)"), options);
  EXPECT_EQ(result.termination, frac::FitTermination::no_usable_start);
  EXPECT_NE(result.message.find("dead time of the model is 20 s"), std::string::npos) << result.message;
}

TEST(TimeFit, AnOutputWithoutResponseIsNotIdentified) {
  TimeResponseData data = furnace_step();
  const TimeResponseData still(data.time(), data.input(), std::vector<double>(data.size(), 5.0));
  for (const std::optional<double> offset : {std::optional<double>{}, std::optional<double>{5.0}}) {
    TimeFitOptions options;
    options.offset = offset;
    const FitResult result = frac::fit(still, furnace_structure(), options);
    EXPECT_EQ(result.termination, frac::FitTermination::no_usable_start);
    EXPECT_NE(result.message.find("The output is 5 throughout"), std::string::npos) << result.message;
    for (const auto& each : result.parameters) EXPECT_FALSE(each.identified);
  }
  support::Random random(1);
  std::vector<double> output;
  for (std::size_t i = 0; i < data.size(); ++i) output.push_back(5 + random.normal());
  const FitResult noise = frac::fit(TimeResponseData(data.time(), data.input(), output), Structure("K/(T s + 1)"));
  EXPECT_NE(noise.message.find("Without any response"), std::string::npos) << noise.message;
  EXPECT_FALSE(estimate(noise, "K").identified);
  EXPECT_FALSE(estimate(noise, "T").identified);
  EXPECT_TRUE(estimate(noise, "offset").identified);
}

// With b1 = 0 the order a1 moves nothing, and the offset is what it is.
TEST(TimeFit, AnUnseenParameterThatMovesNothingLeavesTheOffsetIdentified) {
  const std::vector<double> time = even_times(15, 301);
  const TimeResponseData exact = data_of("1/(0.8 s + 1)", time, std::vector<double>(time.size(), 1.0));
  support::Random random(3);
  std::vector<double> output = exact.output();
  for (double& each : output) each += 0.01 * random.normal();
  const TimeResponseData data(exact.time(), exact.input(), output);
  TimeFitOptions options;
  options.constraints = {{"b1", 0.0, {}, {}, {}}, {"a1", {}, 0.1, 0.9, 0.5}};
  const FitResult result = frac::fit(data, Structure("K/(T s + b1 s^a1 + 1)"), options);
  EXPECT_FALSE(estimate(result, "a1").identified);
  EXPECT_TRUE(estimate(result, "offset").identified) << result.message;
}

// The model reacts to the input throughout, while outputs that do not count may be anything.
TEST(TimeFit, OutputsLeftOutDoNotMatter) {
  const TimeResponseData exact = furnace_step();
  std::vector<double> output = exact.output();
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < output.size(); ++i) {
    if (exact.time()[i] > 1 && exact.time()[i] < 9 && i % 3 != 0) {
      index.push_back(i);
    } else {
      output[i] = 1e3;
    }
  }
  const TimeResponseData data = TimeResponseData(exact.time(), exact.input(), output).observed_at(index);
  const FitResult result = frac::fit(data, furnace_structure());
  EXPECT_EQ(result.residuals, index.size());
  // Without start and end the condition is a hundred times that of all samples.
  expect_values(result, {{"a2", 0.8}, {"q2", 2.2}, {"a1", 0.5}, {"q1", 0.9}, {"offset", 0}}, 100 * to_rounding);
  const std::vector<double> model = frac::fitted_output(result, data);
  for (std::size_t i = 0; i < model.size(); ++i) EXPECT_NEAR(model[i], exact.output()[i], 1e-9);
}

// One sample in twenty is off by 100 standard deviations of the noise.  What is left is that of least squares on clean
// data to 5 % (efficiency of the losses) and a little: five standard errors are exceeded once in a million.
TEST(TimeFit, RobustLossesDoNotFollowOutliers) {
  const TimeResponseData exact = furnace_step();
  support::Random random(3);
  std::vector<double> output = exact.output();
  std::vector<std::size_t> spoiled;
  for (std::size_t i = 0; i < output.size(); ++i) {
    output[i] += 0.01 * random.normal();
    if (i % 20 != 7) continue;
    output[i] += 1;
    spoiled.push_back(i);
  }
  const TimeResponseData data(exact.time(), exact.input(), output);
  TimeFitOptions options;
  for (const frac::Loss loss : {frac::Loss::huber, frac::Loss::cauchy}) {
    options.loss = loss;
    const FitResult result = frac::fit(data, furnace_structure(), options);
    EXPECT_EQ(result.outliers, spoiled);
    for (const auto& [name, value] : {std::pair{"a2", 0.8}, {"q2", 2.2}, {"a1", 0.5}, {"q1", 0.9}, {"offset", 0.0}}) {
      EXPECT_NEAR(estimate(result, name).value, value, 5 * estimate(result, name).standard_error) << name;
      EXPECT_LT(estimate(result, name).standard_error, 0.02) << name;
    }
    EXPECT_LT(result.loss_cost, result.cost);
  }
}

// With K and offset free alone the cost is a parabola, and the profile its curvature's interval.
TEST(TimeFit, ProfileOfALinearModelIsTheIntervalOfItsCurvature) {
  support::Random random(5);
  const std::vector<double> time = even_times(4, 60);
  std::vector<double> output;
  for (const double t : time) output.push_back(2 - 3 * std::expm1(-t) + 0.1 * random.normal());
  const TimeResponseData data(time, std::vector<double>(time.size(), 1.0), output);
  TimeFitOptions options;
  options.constraints = {{"T", 1.0, {}, {}, {}}};
  const FitResult result = frac::fit(data, Structure("K/(T s + 1)"), options);
  for (const char* name : {"K", "offset"}) {
    const frac::ProfileInterval profile = frac::profile_interval(data, options, result, name);
    // The bracket of the profile is closed to 1e-6.
    EXPECT_NEAR(profile.lower, estimate(result, name).ci95_lower, 1e-5) << name;
    EXPECT_NEAR(profile.upper, estimate(result, name).ci95_upper, 1e-5) << name;
  }
  // Half of 400 refits' standard deviation is known to 1/sqrt(2 400) = 3.5 %, that of the 60 residuals themselves to
  // 1/sqrt(120) = 9 %, which both share.
  const auto intervals = frac::bootstrap(data, options, result, 400, 2);
  EXPECT_NEAR(intervals[0].standard_error, estimate(result, "K").standard_error,
              0.15 * estimate(result, "K").standard_error);
  EXPECT_EQ(intervals[1].standard_error, 0);
  EXPECT_NEAR(intervals[2].standard_error, estimate(result, "offset").standard_error,
              0.15 * estimate(result, "offset").standard_error);
  EXPECT_EQ(frac::bootstrap(data, options, result, 400, 1)[0].lower, intervals[0].lower);
}

// Of records like these with noise of 0.01, 7 of 24 are decided, of those with 0.001 11 of 12 and with 0.0003 all
// of 12.
TEST(TimeFit, FractionalOrdersAreSupportedWhereTheyAre) {
  const std::vector<double> time = even_times(15, 151);
  const std::vector<double> step(time.size(), 1.0);
  const std::vector<frac::NamedModel> models{frac::find_model("lag"), frac::find_model("lag-delay"),
                                             frac::find_model("oscillator"), frac::find_model("fractional-lag"),
                                             frac::find_model("cole-davidson")};
  const auto identified = [&](const char* model) {
    support::Random random(8);
    std::vector<double> output =
        support::exact_output(FractionalTransferFunction::parse(model), time, step, Hold::zero_order);
    for (double& value : output) value += 3e-4 * random.normal();
    return frac::identify(TimeResponseData(time, step, output), models, TimeFitOptions{});
  };
  const auto fractional = identified("2/(1.5 s^0.6 + 1)");
  EXPECT_EQ(fractional.verdict, frac::Verdict::fractional_supported) << fractional.verdict_sentence;
  EXPECT_EQ(fractional.ranking[fractional.chosen].name, "fractional-lag");
  EXPECT_TRUE(fractional.skipped.empty());
  const auto integer = identified("2/(1.5 s + 1)");
  EXPECT_EQ(integer.verdict, frac::Verdict::fractional_not_supported) << integer.verdict_sentence;
  EXPECT_EQ(integer.ranking[integer.chosen].name, "lag");
}

TEST(TimeFit, AStructureGrowsWhileTheDataPay) {
  const TimeResponseData exact = furnace_step();
  support::Random random(2);
  std::vector<double> output = exact.output();
  for (double& value : output) value += 0.01 * random.normal();
  const auto growth =
      frac::grow(TimeResponseData(exact.time(), exact.input(), output), frac::GrowthFamily::denominator, {}, 3);
  EXPECT_EQ(growth.chosen, 1u);
  EXPECT_NEAR(estimate(growth.fits[1], "a2").value, 2.2, 0.05);
}

// Under a step a direct term and the offset are one constant.  R0 = 1 beside an arc: with the offset at 0 all comes
// back, exactly but for the rounding of 15 digits.
TEST(TimeFit, HoldsTheOffsetWhereAConstantOfTheModelIsTheSame) {
  const std::vector<double> time = even_times(20, 101);
  const std::vector<double> step(time.size(), 1.0);
  const auto data = data_of("1 + 2/(1 + 3 s^0.8)", time, step);
  const FitResult result = frac::fit(data, Structure("R0 + R1/(1 + T s^n)"));
  expect_values(result, {{"R0", 1}, {"R1", 2}, {"T", 3}, {"n", 0.8}}, 1e-8);
  EXPECT_TRUE(estimate(result, "offset").fixed);
  EXPECT_EQ(estimate(result, "offset").value, 0);
  EXPECT_NE(result.message.find("R0 and the offset are one constant"), std::string::npos) << result.message;
  // An input that begins within the record tells them apart.
  std::vector<double> later = step;
  std::fill_n(later.begin(), 10, 0.0);
  const auto seen = data_of("1 + 2/(1 + 3 s^0.8)", time, later, Hold::zero_order, 4);
  expect_values(frac::fit(seen, Structure("R0 + R1/(1 + T s^n)")), {{"R0", 1}, {"R1", 2}, {"offset", 4}}, 1e-7);
}

// A lag beside an offset of 5 and one beside a constant of its own are the same curve of the same record.
TEST(TimeFit, ConstantAndOffsetLeaveTheSameShareOfTheData) {
  const std::vector<double> time = even_times(6, 61);
  support::Random random(4);
  std::vector<double> output;
  for (const double t : time) output.push_back(5 - std::expm1(-t) + 0.01 * random.normal());
  const TimeResponseData data(time, std::vector<double>(time.size(), 1.0), output);
  const FitResult offset = frac::fit(data, Structure("K/(T s + 1)")),
                  constant = frac::fit(data, Structure("R0 + K/(T s + 1)"));
  ASSERT_TRUE(estimate(constant, "offset").fixed);
  EXPECT_NEAR(constant.rms, offset.rms, 1e-9 * offset.rms);
  EXPECT_NEAR(constant.relative_rms, offset.relative_rms, 1e-9 * offset.relative_rms);
}

TEST(TimeFit, ADriftIsSaidAndEstimated) {
  const std::vector<double> time = even_times(20, 201);
  std::vector<double> input;
  for (const double t : time) input.push_back(std::fmod(t, 7) < 3 ? 1 : -0.5);
  support::Random random(3);
  std::vector<double> output =
      support::exact_output(FractionalTransferFunction::parse("2/(1.5 s^0.7 + 1)"), time, input, Hold::zero_order);
  for (std::size_t i = 0; i < time.size(); ++i) output[i] += 0.3 + 0.05 * time[i] + 0.01 * random.normal();
  const TimeResponseData data(time, input, output);
  const Structure structure("K/(T s^a + 1)");
  const FitResult plain = frac::fit(data, structure);
  EXPECT_NE(plain.message.find("drift"), std::string::npos) << plain.message;
  ASSERT_EQ(plain.advice.size(), 1u);
  EXPECT_EQ(plain.advice[0].remedy, frac::Remedy::estimate_trend);
  TimeFitOptions options;
  options.trend = true;
  const FitResult result = frac::fit(data, structure, options);
  for (const auto& [name, value] : {std::pair{"K", 2.0}, std::pair{"T", 1.5}, std::pair{"a", 0.7},
                                    std::pair{"offset", 0.3}, std::pair{"drift", 0.05}}) {
    // Four standard errors.
    EXPECT_NEAR(estimate(result, name).value, value, 4 * estimate(result, name).standard_error) << name;
    EXPECT_TRUE(estimate(result, name).identified) << name;
  }
  // The fitted output holds the drift: what is left is the noise, known to 1/sqrt(400) = 5 %.
  EXPECT_NEAR(result.rms, 0.01, 0.0015);
  const std::vector<double> fitted = frac::fitted_output(result, data, options);
  double square = 0;
  for (std::size_t i = 0; i < time.size(); ++i) square += std::pow(fitted[i] - output[i], 2);
  EXPECT_NEAR(square, result.cost, 1e-9 * result.cost);
}

// An input before the record, of which the record knows nothing: three units for 1.2 s until the first sample.
TEST(TimeFit, AStartInMotionIsSaidAndEstimated) {
  const std::vector<double> long_time = even_times(30, 301);
  std::vector<double> long_input;
  for (const double t : long_time) long_input.push_back(t < 8.8 ? 0 : t < 10 ? 3 : std::fmod(t - 10, 7) < 3 ? 1 : -0.5);
  const std::vector<double> long_output = support::exact_output(FractionalTransferFunction::parse("2/(1.5 s^0.7 + 1)"),
                                                                long_time, long_input, Hold::zero_order);
  support::Random random(3);
  std::vector<double> time, input, output;
  for (std::size_t i = 100; i < long_time.size(); ++i) {
    time.push_back(long_time[i] - 10);
    input.push_back(long_input[i]);
    output.push_back(long_output[i] + 0.01 * random.normal());
  }
  const TimeResponseData data(time, input, output);
  const Structure structure("K/(T s^a + 1)");
  const FitResult plain = frac::fit(data, structure);
  EXPECT_NE(plain.message.find("start in motion"), std::string::npos) << plain.message;
  TimeFitOptions options;
  options.earlier_input = true;
  const FitResult result = frac::fit(data, structure, options);
  EXPECT_EQ(result.earlier_input.size(), 3u);
  // Of the error of 40 % and more without, what three levels leave of an input of another shape: some per cent.
  EXPECT_GT(std::abs(estimate(plain, "T").value - 1.5), 2 * std::abs(estimate(result, "T").value - 1.5));
  EXPECT_NEAR(estimate(result, "K").value, 2, 0.1);
  EXPECT_NEAR(estimate(result, "a").value, 0.7, 0.05);
  const std::vector<double> fitted = frac::fitted_output(result, data, options);
  double square = 0;
  for (std::size_t i = 0; i < time.size(); ++i) square += std::pow(fitted[i] - output[i], 2);
  EXPECT_NEAR(square, result.cost, 1e-9 * result.cost);
}

// A search that follows outliers first ends far off: three per cent of the samples are off by the size of the output.
// With the loss from the start every record comes back to within 20 %, which is ten standard errors and more.
TEST(TimeFit, RobustLossesAreSearchedWith) {
  const std::vector<double> time = even_times(12, 121);
  const std::vector<double> step(time.size(), 1.0);
  const std::vector<double> exact =
      support::exact_output(FractionalTransferFunction::parse("2/(1.5 s^0.7 + 1)"), time, step, Hold::zero_order);
  TimeFitOptions options;
  options.loss = frac::Loss::cauchy;
  options.offset = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    support::Random random(seed);
    std::vector<double> output = exact;
    for (double& value : output) {
      value += 0.01 * random.normal();
      if (random.unit() < 0.03) value += 3 * random.normal();
    }
    const FitResult result = frac::fit(TimeResponseData(time, step, output), Structure("K/(T s^a + 1)"), options);
    for (const auto& [name, value] : {std::pair{"K", 2.0}, std::pair{"T", 1.5}, std::pair{"a", 0.7}}) {
      EXPECT_NEAR(estimate(result, name).value, value, 0.2 * value) << name << ", seed " << seed;
    }
  }
}

// At rest, without drift, nothing is said: the chance of each test is 1e-4.
TEST(TimeFit, NothingIsSaidOfRecordsAtRest) {
  const TimeResponseData exact = furnace_step();
  support::Random random(21);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<double> output = exact.output();
    for (double& value : output) value += 0.01 * random.normal();
    const FitResult result = frac::fit(TimeResponseData(exact.time(), exact.input(), output), furnace_structure());
    EXPECT_EQ(result.message.find("drift"), std::string::npos) << result.message;
    EXPECT_EQ(result.message.find("motion"), std::string::npos) << result.message;
  }
}

// The square of 1e-200 is 0 and that of 1e200 infinite: intervals of such a fit would have no width, or no end.
TEST(TimeFit, RefusesOutputsWhoseSquaresAreNoNumbers) {
  for (const double size : {1e-200, 1e200}) {
    const TimeResponseData data({0, 1, 2, 3, 4}, {1, 1, 1, 1, 1}, {0, 0.4 * size, 0.6 * size, 0.8 * size, size});
    expect_invalid_argument([&] { (void)frac::fit(data, frac::Structure("K/(T s + 1)"), frac::TimeFitOptions{}); },
                            {"another unit"});
  }
}

// A dead time of at least the whole record would leave no output that the input reaches.
TEST(TimeFit, RefusesDeadTimesBeyondTheRecord) {
  const TimeResponseData data({0, 1, 2, 3, 4, 5}, {1, 1, 1, 1, 1, 1}, {0, 0, 0.4, 0.6, 0.8, 0.9});
  frac::TimeFitOptions options;
  options.constraints.push_back({"L", {}, 7, {}, {}});
  expect_invalid_argument([&] { (void)frac::fit(data, frac::Structure("K exp(-L s)/(T s + 1)"), options); },
                          {"'L'", "lower limit 7 s", "record of 5 s"});
}

TEST(TimeResponseData, RefusesWhatIsNoRecord) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> t{0, 1, 2}, u{1, 1, 1}, y{0, 1, 2};
  expect_invalid_argument([&] { TimeResponseData({0, 1}, u, y); }, {"lengths differ", "2 times", "3 inputs"});
  expect_invalid_argument([&] { TimeResponseData({0}, {1}, {1}); }, {"1 samples"});
  expect_invalid_argument([&] { TimeResponseData({0, 1, 1}, u, y); }, {"time[2] = 1 s"});
  expect_invalid_argument([&] { TimeResponseData(t, u, {0, nan, 1}); }, {"output[1] = nan"});
  expect_invalid_argument([&] { TimeResponseData(t, {1, nan, 1}, y); }, {"input[1] = nan"});
  expect_invalid_argument([&] { TimeResponseData(t, u, y, {1, 0, 1}); }, {"sigma[1] = 0"});
  expect_invalid_argument([&] { TimeResponseData(t, {2, 2, 2}, y, {}, Hold::zero_order, 2); }, {"nothing drives"});
  expect_invalid_argument([&] { (void)TimeResponseData(t, u, y).observed_at({}); }, {"no output is left"});
  expect_invalid_argument([&] { (void)TimeResponseData(t, u, y).observed_at({1, 1}); }, {"observed[1] = 1"});
  expect_invalid_argument([&] { (void)TimeResponseData(t, u, y).observed_at({3}); }, {"observed[0] = 3"});
}
