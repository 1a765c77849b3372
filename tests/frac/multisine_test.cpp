// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/multisine.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace {

using frac::MultisineLines;
using frac::MultisineOptions;
using std::numbers::pi;

// Lines 3 to 60 of a period of 1 s with 250 samples.
MultisineOptions example(MultisineLines lines, std::uint64_t seed = 1) {
  MultisineOptions options;
  options.lower = 2 * pi * 3;
  options.upper = 2 * pi * 60;
  options.period = 1;
  options.sample_time = 0.004;
  options.lines = lines;
  options.peak = 2;
  options.seed = seed;
  return options;
}

double amplitude_on(const std::vector<double>& samples, std::size_t line) {
  std::complex<double> sum = 0;
  const std::size_t count = samples.size();
  for (std::size_t i = 0; i < count; ++i)
    sum += samples[i] * std::polar(2.0 / static_cast<double>(count),
                                   -2 * pi * static_cast<double>(line * i % count) / static_cast<double>(count));
  return std::abs(sum);
}

// Direct sums against those over a chirp: both err by rounding of 250 samples of size 2.
TEST(Multisine, HasItsAmplitudeOnItsLinesAndNothingElsewhere) {
  for (const auto lines : frac::multisine_lines()) {
    const auto found = frac::multisine(example(lines));
    ASSERT_EQ(found.samples.size(), 250U);
    double peak = 0, squares = 0;
    for (const double each : found.samples) {
      peak = std::max(peak, std::abs(each));
      squares += each * each / 250;
    }
    EXPECT_NEAR(peak, 2, 1e-12);
    EXPECT_NEAR(found.crest_factor, peak / std::sqrt(squares), 1e-9);
    for (std::size_t k = 1; k < 125; ++k) {
      const bool excited = std::binary_search(found.lines.begin(), found.lines.end(), k);
      EXPECT_NEAR(amplitude_on(found.samples, k), excited ? found.amplitude : 0, 1e-12) << k;
    }
  }
}

TEST(Multisine, ExcitesTheLinesThatAreAskedFor) {
  const auto full = frac::multisine(example(MultisineLines::full)).lines,
             odd = frac::multisine(example(MultisineLines::odd)).lines;
  EXPECT_EQ(full.size(), 58U);
  EXPECT_EQ(full.front(), 3U);
  EXPECT_EQ(full.back(), 60U);
  EXPECT_EQ(odd.size(), 29U);
  EXPECT_TRUE(std::all_of(odd.begin(), odd.end(), [](std::size_t k) { return k % 2 == 1; }));
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    auto options = example(MultisineLines::odd_random, seed);
    options.rounds = 0;
    const auto random = frac::multisine(options).lines;
    EXPECT_EQ(random.front(), 3U);
    EXPECT_EQ(random.back(), 59U);
    // Seven whole groups of four: one hole in each, but for those at the ends of the band.
    EXPECT_GE(random.size(), 29U - 8);
    EXPECT_LE(random.size(), 29U - 6);
    EXPECT_TRUE(std::all_of(random.begin(), random.end(), [](std::size_t k) { return k % 2 == 1; }));
  }
}

// Random phases have a crest factor of 2.5 to 3.5, the phases of Schroeder (1970) 1.7 to 1.8.
TEST(Multisine, HasALowerPeakThanThePhasesOfSchroeder) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed)
    EXPECT_LT(frac::multisine(example(MultisineLines::full, seed)).crest_factor, 1.7) << seed;
}

TEST(Multisine, SaysWhatIsOutOfRange) {
  const auto refused = [](auto change, const std::vector<std::string>& words) {
    auto options = example(MultisineLines::full);
    change(options);
    support::expect_invalid_argument([&] { static_cast<void>(frac::multisine(options)); }, words);
  };
  refused([](auto& o) { o.upper = 2 * pi * 125; }, {"band", "half the sampling rate"});
  refused([](auto& o) { o.lower = 0; }, {"band is 0"});
  refused([](auto& o) { o.period = 0.9999; }, {"period is 0.9999", "whole number"});
  refused([](auto& o) { o.sample_time = -1; }, {"sample_time is -1"});
  refused([](auto& o) { o.peak = 0; }, {"peak is 0"});
  refused([](auto& o) { o.rounds = -1; }, {"rounds is -1"});
  refused([](auto& o) { o.lower = 2 * pi * 4.2, o.upper = 2 * pi * 4.8; }, {"band holds no line"});
}

// Seconds that a step is measured for.
double measured(const frac::SteppedSineStep& step) {
  return static_cast<double>(step.measuring) * 2 * pi / step.omega;
}

// Steps follow one another, settle for their cycles, and measure as long as each other: less by a part of a cycle of
// their own.
TEST(SteppedSinePlan, MeasuresAsLongAtEachFrequency) {
  const std::vector<double> omega{2, 5, 11, 30, 100};
  for (const double total : {200.0, 1000.0}) {
    const auto plan = frac::stepped_sine_plan(omega, total, 8);
    ASSERT_EQ(plan.size(), omega.size());
    double settling = 0, at = 0;
    for (const double each : omega) settling += 8 * 2 * pi / each;
    const double share = (total - settling) / static_cast<double>(omega.size());
    for (std::size_t i = 0; i < plan.size(); ++i) {
      EXPECT_EQ(plan[i].omega, omega[i]);
      EXPECT_EQ(plan[i].settling, 8U);
      EXPECT_NEAR(plan[i].begin, at, 1e-12 * total);
      at += 8 * 2 * pi / omega[i] + measured(plan[i]);
      EXPECT_NEAR(plan[i].end, at, 1e-12 * total);
      EXPECT_LE(measured(plan[i]), share * (1 + 1e-12));
      EXPECT_GT(measured(plan[i]), share - 2 * pi / omega[i]);
    }
  }
}

// Six cycles at 0.1 rad/s take 377 s of 500: the others share what they leave.  One second less than six cycles of all
// take is refused.
TEST(SteppedSinePlan, MeasuresSixCyclesOrMore) {
  const auto plan = frac::stepped_sine_plan({0.1, 10, 20}, 500, 0);
  EXPECT_EQ(plan[0].measuring, 6U);
  for (const std::size_t i : {1U, 2U})
    EXPECT_EQ(plan[i].measuring, static_cast<std::size_t>((500 - 6 * 2 * pi / 0.1) / 2 / (2 * pi / plan[i].omega)));
  EXPECT_LE(plan.back().end, 500);
  support::expect_invalid_argument(
      [] {
        static_cast<void>(frac::stepped_sine_plan({0.1, 10}, 379, 0));
      },
      {"total_time is 379 s", "380.7", "2 frequencies"});
  support::expect_invalid_argument(
      [] {
        static_cast<void>(frac::stepped_sine_plan({1, -2}, 100, 0));
      },
      {"omega holds -2 rad/s"});
  support::expect_invalid_argument([] { static_cast<void>(frac::stepped_sine_plan({}, 100, 0)); }, {"omega is empty"});
}

}  // namespace
