// SPDX-License-Identifier: BSD-3-Clause
#include "records/settling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "frac/records/response.hpp"
#include "support/random.hpp"

namespace {

using frac::Record;
using frac::detail::settling_of;
using std::numbers::pi;

constexpr double period = 23.7;

// A sine and what a machine makes of it: amplitude 1 + what `departure` says of the cycle.
Record record_of(double cycles, double noise, const std::function<double(double)>& departure, support::Random& random) {
  const auto count = static_cast<std::size_t>(cycles * period) + 1;
  std::vector<double> input(count), output(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double cycle = static_cast<double>(i) / period;
    input[i] = std::cos(2 * pi * cycle);
    output[i] = (1 + departure(cycle)) * std::cos(2 * pi * cycle - 0.7) + 0.1 * std::cos(6 * pi * cycle) +
                noise * random.normal();
  }
  return {1, input, {output}};
}

// Each test is wrong once in 1000 segments: of 3000 that is 3, and more than 10 with a chance of 3e-4.
TEST(Settling, SteadyResponsesAreLeftWhole) {
  support::Random random(1);
  int cut = 0, changed = 0;
  for (int i = 0; i < 3000; ++i) {
    const auto found =
        settling_of(record_of(
                        6 + static_cast<double>(random.below(20)), 0.1, [](double) { return 0; }, random),
                    period);
    cut += found.cut > 0 ? 1 : 0;
    changed += found.changes_after > 0 ? 1 : 0;
  }
  EXPECT_LE(cut, 10);
  EXPECT_LE(changed, 10);
}

// The phasor of a cycle scatters by s = 0.1 sqrt(2/23.7) = 0.029 in each part.  A departure of 3 exp(-c/2) in cycle c
// is 17 s in cycle 3, which single cycles show, and the mean of cycles 6 to 9 is still 2.5 s off that of the 14 after
// them, five deviations of the difference.  From cycle 10 on it is below 0.7 s: only by chance is more cut than 11.
TEST(Settling, CutsWhatSettles) {
  support::Random random(2);
  int by_chance = 0;
  for (int i = 0; i < 200; ++i) {
    const auto found = settling_of(record_of(
                                       24, 0.1, [](double c) { return 3 * std::exp(-c / 2); }, random),
                                   period);
    EXPECT_GE(found.cut, 4U);
    by_chance += found.cut > 11 ? 1 : 0;
    EXPECT_EQ(found.cycles, 24U);
  }
  EXPECT_LE(by_chance, 10);
}

// A jump of 0.3 after cycle 15 of 20 is ten deviations of a cycle.
TEST(Settling, SaysWhereTheResponseJumps) {
  support::Random random(3);
  int near = 0;
  for (int i = 0; i < 200; ++i) {
    const auto found = settling_of(record_of(
                                       20, 0.1, [](double c) { return c < 15 ? 0 : 0.3; }, random),
                                   period);
    near += found.changes_after >= 14 && found.changes_after <= 16 ? 1 : 0;
  }
  EXPECT_EQ(near, 200);
}

// A transient that the test cuts does not bias the response, and a jump leaves no value with a deviation.
TEST(Settling, IsUsedByTheResponse) {
  support::Random random(4);
  const auto settles = frac::response({record_of(
      24, 1e-3, [](double c) { return 3 * std::exp(-c); }, random)});
  ASSERT_EQ(settles.outputs[0].size(), 1U);
  const auto& point = settles.outputs[0][0];
  EXPECT_LT(std::abs(point.value - std::polar(1.0, -0.7)), 4 * std::sqrt(2.0) * point.sigma);
  // 1e-3 sqrt(2/(12 * 23.7)) at most, and what the polynomial adds.
  EXPECT_LT(point.sigma, 1.5e-4);
  ASSERT_EQ(settles.remarks.size(), 1U);
  EXPECT_NE(settles.remarks[0].find("still settled"), std::string::npos);
  // Cycles of a segment begin where the sine rises through its mean, first at 0.75 periods: the jump at 15 is in the
  // fifteenth of 23.
  const auto jumps = frac::response({record_of(
      24, 1e-3, [](double c) { return c < 15 ? 0 : 0.3; }, random)});
  EXPECT_NE(jumps.outputs[0][0].flag.find("changes after cycle 14 of 23"), std::string::npos)
      << jumps.outputs[0][0].flag;
  EXPECT_FALSE(jumps.usable());
}

}  // namespace
