// SPDX-License-Identifier: BSD-3-Clause
#include "time_response/steady_response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include "formula/reduction.hpp"
#include "frac/structure.hpp"
#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/response_methods.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
using frac::FractionalTransferFunction;
using frac::detail::EventResponse;
using frac::detail::LineSum;
using frac::detail::PeriodicInput;
using frac::detail::SteadyResponse;

std::vector<std::size_t> all_of(std::size_t count) {
  std::vector<std::size_t> index(count);
  std::iota(index.begin(), index.end(), std::size_t{0});
  return index;
}

std::vector<double> even_times(double step, std::size_t count) {
  std::vector<double> time;
  for (std::size_t i = 0; i < count; ++i) time.push_back(step * static_cast<double>(i));
  return time;
}

std::vector<Complex> random_lines(std::size_t count, std::uint64_t seed) {
  support::Random random(seed);
  std::vector<Complex> line;
  for (std::size_t k = 0; k < count; ++k) line.emplace_back(random.normal(), k == 0 ? 0 : random.normal());
  return line;
}

/// Steady state of a model by parameters at every sample.
EventResponse::Result steady(const char* formula, const std::vector<double>& parameters,
                             const std::vector<double>& time, const std::vector<double>& input) {
  const frac::Structure structure(formula);
  const SteadyResponse response(std::make_shared<const PeriodicInput>(time, input), all_of(time.size()));
  EventResponse::Result result;
  EXPECT_TRUE(response.evaluate(
      frac::detail::reduce(structure.expression(), parameters, frac::detail::Sensitivity::all), result));
  return result;
}

// Cosines summed one by one; both sums round some 1e-15 for each of at most 25 lines of size 1.
TEST(LineSum, IsTheSumOfItsCosines) {
  for (const double period : {8.0, 9.0, 7.3, 49.9}) {
    constexpr std::size_t samples = 120;
    const LineSum sum(samples, period);
    const std::vector<Complex> line = random_lines(sum.lines(), 3);
    const std::vector<double> signal = sum(line);
    for (std::size_t m = 0; m < samples; ++m) {
      double exact = 0;
      for (std::size_t k = 0; k < line.size(); ++k) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(k * m) / period;
        exact += (line[k] * std::polar(1.0, angle)).real();
      }
      EXPECT_NEAR(signal[m], exact, 1e-12) << period;
    }
  }
}

// Two periods or more determine every line below half the sampling rate, whole or not, also where some samples are
// missing.  Conjugate gradients end at 1e-13 of the first gradient.
TEST(LineSum, LinesComeBackFromPeriodsThatAreNotWhole) {
  for (const double period : {8.0, 9.0, 7.3, 49.9}) {
    constexpr std::size_t samples = 130;
    const LineSum sum(samples, period);
    const std::vector<Complex> line = random_lines(sum.lines(), 5);
    const std::vector<double> signal = sum(line);
    std::vector<std::size_t> some;
    for (std::size_t m = 0; m < samples; ++m)
      if (m % 11 != 4) some.push_back(m);
    for (const auto& index : {all_of(samples), some}) {
      const std::vector<Complex> found = sum.fitted(signal, index);
      for (std::size_t k = 0; k < line.size(); ++k)
        EXPECT_LT(std::abs(found[k] - line[k]), 1e-10) << period << " " << k;
    }
  }
}

// Levels held for some samples have plateaus in their correlation; a period is a number of samples or none.
TEST(LineSum, HeldLevelsHaveAPeriodOfSamplesOrNone) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    support::Random random(seed);
    std::vector<double> input;
    for (int i = 0; i < 200; ++i) input.push_back(i > 0 && random.unit() < 0.9 ? input.back() : random.normal());
    if (std::all_of(input.begin(), input.end(), [&](double each) { return each == input.front(); })) continue;
    const frac::detail::InputPeriod period = frac::detail::input_period(input);
    EXPECT_TRUE(period.samples > 2 && period.samples <= 200) << seed << ": " << period.samples;
  }
}

// The response to a sine from rest has forgotten its start after forty time constants to e^-40 = 4e-18; two sines at
// 2.9 and 6.3 samples per period are the input.  The reference is good to some 1e-15.
TEST(SteadyResponse, IsWhatARunFromRestTendsTo) {
  constexpr double step = 0.7, since = 60;
  constexpr std::size_t period = 63, samples = 140;
  const double slow = 2 * std::numbers::pi * 10 / (period * step), fast = 2 * std::numbers::pi * 22 / (period * step);
  const FractionalTransferFunction model =
      FractionalTransferFunction::parse("exp(-0.3 s)*(2 s + 3)/(s^2 + 2.2 s + 1.5)");
  std::vector<double> input, later;
  const std::vector<double> time = even_times(step, samples);
  for (const double t : time) {
    input.push_back(0.5 + std::sin(slow * (t + since)) - 0.6 * std::sin(fast * (t + since)));
    later.push_back(t + since);
  }
  using Kind = frac::ResponseInput::Kind;
  const auto first = frac::reference_response(model, {Kind::sine, slow}, later);
  const auto second = frac::reference_response(model, {Kind::sine, fast}, later);
  const auto steady = frac::respond(model, frac::SampledInput{time, input, frac::Hold::band_limited}, time);
  EXPECT_TRUE(steady.meets_tolerance);
  for (std::size_t i = 0; i < samples; ++i)
    EXPECT_NEAR(steady.output[i], 0.5 * 3 / 1.5 + first[i].value - 0.6 * second[i].value, 1e-11);
}

// |H| and arg H of a half-order lag at a line, for a period that is no whole number of samples.
TEST(SteadyResponse, TurnsASineByTheResponseOfTheModel) {
  constexpr double period = 12.7, step = 0.05;
  const double omega = 2 * std::numbers::pi / (period * step);
  const std::vector<double> time = even_times(step, 140);
  std::vector<double> input;
  for (const double t : time) input.push_back(std::cos(omega * t));
  const auto result = steady("K exp(-L s)/(T s^a + 1)", {2, 0.03, 0.4, 0.5}, time, input);
  const Complex response =
      2.0 * std::polar(1.0, -0.03 * omega) / (0.4 * std::polar(std::sqrt(omega), std::numbers::pi / 4) + 1.0);
  for (std::size_t i = 0; i < time.size(); ++i) {
    // The period is found in the samples, by Gauss and Newton's steps to rounding.
    EXPECT_NEAR(result.value[static_cast<Eigen::Index>(i)], (response * std::polar(1.0, omega * time[i])).real(), 1e-9);
  }
}

// Central differences of step h = 1e-5 err by h^2/6 of a third derivative of about 1e2 here and by 1e-15/h.
TEST(SteadyResponse, DerivativesAgreeWithDifferences) {
  support::Random random(2);
  std::vector<double> one, input;
  for (int i = 0; i < 17; ++i) one.push_back(random.normal());
  for (int i = 0; i < 40; ++i) input.push_back(one[static_cast<std::size_t>(i % 17)]);
  const std::vector<double> time = even_times(0.2, input.size());
  const char* const formula = "K exp(-L s)*(b s^q + 1)/(T s^a + c s^q + 1)";
  const std::vector<double> at{2, 0.13, 0.4, 0.7, 0.9, 1.4, 0.3};
  const auto result = steady(formula, at, time, input);
  for (std::size_t p = 0; p < at.size(); ++p) {
    constexpr double h = 1e-5;
    std::vector<double> above = at, below = at;
    above[p] += h;
    below[p] -= h;
    const Eigen::VectorXd slope =
        (steady(formula, above, time, input).value - steady(formula, below, time, input).value) / (2 * h);
    EXPECT_LT((slope - result.gradient.col(static_cast<Eigen::Index>(p))).lpNorm<Eigen::Infinity>(), 1e-7) << p;
  }
}

TEST(SteadyResponse, AnIntegratorLeavesTheMeanOfItsInputOut) {
  const std::vector<double> time = even_times(0.1, 40);
  std::vector<double> input;
  const double omega = 2 * std::numbers::pi / 2;
  for (const double t : time) input.push_back(3 + std::cos(omega * t));
  const auto result = steady("K/s", {5}, time, input);
  for (std::size_t i = 0; i < time.size(); ++i)
    EXPECT_NEAR(result.value[static_cast<Eigen::Index>(i)], 5 / omega * std::sin(omega * time[i]), 1e-10);
}

TEST(SteadyResponse, RefusesWhatHasNone) {
  using frac::Hold;
  const FractionalTransferFunction lag = FractionalTransferFunction::parse("1/(s + 1)");
  const std::vector<double> uneven{0, 1, 2, 3.5}, wave{1, -1, 1, -1};
  support::expect_invalid_argument(
      [&] {
        return frac::respond(lag, frac::SampledInput{uneven, wave, Hold::band_limited}, uneven);
      },
      {"time[1]"});
  const std::vector<double> even{0, 1, 2, 3};
  support::expect_invalid_argument(
      [&] {
        return frac::respond(lag, frac::SampledInput{even, {1, 1, 1, 1}, Hold::band_limited}, even);
      },
      {"does not change"});
  support::expect_invalid_argument([&] { return frac::respond(lag, even, 1.0, 1e-9, Hold::band_limited); },
                                   {"band-limited"});
  support::expect_invalid_argument(
      [&] {
        return frac::respond(lag, frac::SampledInput{even, {1, 2, 1, 1}, Hold::band_limited}, even, 1e-9,
                             frac::ResponseMethod::bdf2);
      },
      {"bdf2"});
}

}  // namespace
