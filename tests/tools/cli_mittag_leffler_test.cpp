// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::complex<double> value_of(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{"mittag-leffler"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const auto result = run_fracfit(all);
  EXPECT_EQ(result.code, 0) << result.error;
  std::size_t comma = 0;
  const double re = std::stod(result.output, &comma);
  EXPECT_EQ(result.output[comma], ',') << result.output;
  EXPECT_EQ(result.output.back(), '\n');
  return {re, std::stod(result.output.substr(comma + 1))};
}

// E_1 = exp, E_{1/2}(z) = exp(z^2) erfc(-z), E_{2,2}(z) = sinh(sqrt z)/sqrt z: a few roundings each.
TEST(MittagLeffler, PrintsValuesThatRoundTrip) {
  EXPECT_NEAR(value_of({"--alpha", "1", "--z", "-3"}).real() / std::exp(-3.0), 1, 4e-16);
  EXPECT_NEAR(value_of({"--alpha", "0.5", "--beta", "1", "--z", "-1"}).real() / (std::exp(1.0) * std::erfc(1.0)), 1,
              1e-15);
  const std::complex<double> z(0.5, -1.25);
  const std::complex<double> exact = std::sinh(std::sqrt(z)) / std::sqrt(z);
  EXPECT_LT(std::abs(value_of({"--alpha", "2", "--beta", "2", "--z", "0.5,-1.25"}) - exact), 1e-15);
  EXPECT_EQ(value_of({"--alpha", "0.5", "--z=-2"}).imag(), 0);
}

// E^2_{1,1}(z) = sum (k + 1) z^k/k! = (1 + z) e^z, to the 1e-12 (1 + |E|) of the function.
TEST(MittagLeffler, TakesAThirdParameter) {
  EXPECT_NEAR(value_of({"--alpha", "1", "--gamma", "2", "--z", "-3"}).real(), -2 * std::exp(-3.0), 1.1e-12);
  const std::complex<double> z(0.5, -1.25);
  EXPECT_LT(std::abs(value_of({"--alpha", "1", "--gamma", "2", "--z", "0.5,-1.25"}) - (1.0 + z) * std::exp(z)), 4e-12);
}

TEST(MittagLeffler, OverflowIsNoUsableResult) {
  const auto result = run_fracfit({"mittag-leffler", "--alpha", "0.5", "--z", "100"});
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(result.output, "inf,0\n");
  EXPECT_NE(result.error.find("beyond the range"), std::string::npos) << result.error;
}

TEST(MittagLeffler, WrongUsageIsNamed) {
  const auto expect_usage = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_usage({"mittag-leffler", "--alpha", "0.5"}, "--z");
  expect_usage({"mittag-leffler", "--alpha", "0", "--z", "1"}, "alpha = 0");
  expect_usage({"mittag-leffler", "--alpha", "1", "--gamma", "0", "--z", "1"}, "gamma = 0");
  expect_usage({"mittag-leffler", "--alpha", "x", "--z", "1"}, "--alpha");
  expect_usage({"mittag-leffler", "--alpha", "1", "--z", "1,2,3"}, "RE,IM");
  expect_usage({"mittag-leffler", "--alpha", "1", "--z", "nan"}, "--z");
}

}  // namespace
