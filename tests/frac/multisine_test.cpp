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

}  // namespace
