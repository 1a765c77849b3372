// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/frequency_response_data.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/expect_invalid_argument.hpp"

namespace {

using support::expect_invalid_argument;
using Values = std::vector<std::complex<double>>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FrequencyResponseData, KeepsWhatItWasGiven) {
  const frac::FrequencyResponseData data({1, 2, 2, 3}, {1, {0, 1}, 2, -1}, {0.1, 0.2, 0.3, 0.4});
  EXPECT_EQ(data.size(), 4u);
  EXPECT_EQ(data.omega(), (std::vector<double>{1, 2, 2, 3}));
  EXPECT_EQ(data.value(), (Values{1, {0, 1}, 2, -1}));
  EXPECT_EQ(data.sigma(), (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_TRUE(frac::FrequencyResponseData({1}, {1}).sigma().empty());
}

TEST(FrequencyResponseData, NamesTheFirstFrequencyThatIsNotAllowed) {
  expect_invalid_argument([] { frac::FrequencyResponseData({0, 1}, {1, 1}); }, {"omega[0] = 0 rad/s"});
  expect_invalid_argument([] { frac::FrequencyResponseData({-2}, {1}); }, {"omega[0] = -2 rad/s"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1, nan}, {1, 1}); }, {"omega[1] = nan"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1, infinity}, {1, 1}); }, {"omega[1] = inf"});
  expect_invalid_argument(
      [] {
        frac::FrequencyResponseData({1, 3, 2}, {1, 1, 1});
      },
      {"omega[2] = 2 rad/s", "(3 rad/s)", "increasing order"});
}

TEST(FrequencyResponseData, NamesTheFirstValueThatIsNotFinite) {
  expect_invalid_argument(
      [] {
        frac::FrequencyResponseData({1, 2}, {1, {0, nan}});
      },
      {"value[1] = 0 + j nan", "2 rad/s"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1}, {infinity}); }, {"value[0]", "not finite"});
}

TEST(FrequencyResponseData, NamesTheFirstSigmaThatIsNotPositive) {
  expect_invalid_argument([] { frac::FrequencyResponseData({1, 2}, {1, 1}, {0.1, 0}); }, {"sigma[1] = 0"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1}, {1}, {nan}); }, {"sigma[0] = nan"});
}

TEST(FrequencyResponseData, RefusesEmptyAndUnequalLengths) {
  expect_invalid_argument([] { frac::FrequencyResponseData({}, {}); }, {"no points"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1, 2}, {1}); }, {"2 frequencies, 1 values"});
  expect_invalid_argument([] { frac::FrequencyResponseData({1, 2}, {1, 1}, {1}); }, {"1 sigmas"});
}

}  // namespace
