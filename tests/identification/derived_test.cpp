// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/derived.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "support/expect_invalid_argument.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

const std::vector<std::string> names{"R1", "Q1", "n1"};

TEST(DerivedQuantity, PropagatesErrorsInClosedForm) {
  const DerivedQuantity summit("f1 = (R1 Q1)^(-1/n1)/(2 pi)", names);
  const std::vector<double> at{3, 0.2, 0.8};
  const std::vector<std::vector<double>> covariance{{1e-4, 2e-6, 0}, {2e-6, 1e-6, -3e-6}, {0, -3e-6, 4e-4}};
  const DerivedEstimate estimate = summit.at(at, covariance, 2);
  const double value = std::pow(0.6, -1.25) / (2 * std::numbers::pi);
  // d ln f = -dR/(n R) - dQ/(n Q) + ln(R Q)/n^2 dn
  const double slope[] = {-value / 2.4, -value / 0.16, value * std::log(0.6) / 0.64};
  double variance = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) variance += slope[i] * slope[j] * covariance[i][j];
  // Some ten roundings.
  EXPECT_EQ(estimate.name, "f1");
  EXPECT_NEAR(estimate.value, value, 1e-14 * value);
  EXPECT_NEAR(estimate.standard_error, std::sqrt(variance), 1e-13 * std::sqrt(variance));
  EXPECT_NEAR(estimate.ci95_upper - estimate.ci95_lower, 4 * std::sqrt(variance), 1e-13 * value);
}

TEST(DerivedQuantity, AParameterWithoutErrorMattersOnlyWhereItStands) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> at{3, 0.2, 0.8};
  const std::vector<std::vector<double>> covariance{{0.04, nan, 0}, {nan, nan, nan}, {0, nan, 1}};
  EXPECT_NEAR(DerivedQuantity("G = 1/R1", names).at(at, covariance, 2).standard_error, 0.2 / 9, 1e-15);
  const DerivedEstimate blind = DerivedQuantity("tau = R1 Q1", names).at(at, covariance, 2);
  EXPECT_NEAR(blind.value, 0.6, 1e-15);
  EXPECT_TRUE(std::isnan(blind.standard_error));
  EXPECT_TRUE(std::isnan(DerivedQuantity("x = sqrt(n1 - R1)", names).at(at, covariance, 2).value));
}

TEST(DerivedQuantity, SaysWhatIsNoQuantity) {
  const auto refused = [](const char* definition, const std::vector<std::string>& parts) {
    support::expect_invalid_argument([&] { return DerivedQuantity(definition, names); }, parts);
  };
  refused("R1 Q1", {"NAME = FORMULA"});
  refused(" = R1", {"NAME = FORMULA"});
  refused("x = R1 s", {"depends on s"});
  refused("x = R2", {"'R2'", "R1, Q1, n1"});
  refused("x = R1 +", {});
}

// 300 fits of an arc with one per cent of noise, seeds used for nothing else: the count of intervals that hold the
// summit is binomial, and the limit lies 3.3 standard deviations below 95 %.
TEST(DerivedQuantity, IntervalsHoldTheSummitOfAnArc) {
  constexpr int trials = 300;
  std::mt19937_64 generator(4711);
  const char* formula = "R0 + R1/(1 + R1 Q1 s^n1)";
  const Structure structure(formula);
  const std::vector<DerivedQuantity> summit{
      DerivedQuantity("f1 = (R1 Q1)^(-1/n1)/(2 pi)", structure.parameter_names())};
  const double truth = std::pow(0.6, -1.25) / (2 * std::numbers::pi);
  FitOptions options;
  options.component = Component::both;
  options.global_start = false;
  options.constraints = {
      {"R0", {}, {}, {}, 1}, {"R1", {}, {}, {}, 3}, {"Q1", {}, {}, {}, 0.2}, {"n1", {}, {}, {}, 0.8}};
  int held = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto data = support::noisy_response(formula, {1, 3, 0.2, 0.8}, 0.01, generator, 40);
    const auto derived = derived_estimates(fit(data, structure, options), summit);
    held += derived[0].ci95_lower <= truth && truth <= derived[0].ci95_upper;
  }
  RecordProperty("share", std::to_string(held / static_cast<double>(trials)));
  EXPECT_GT(held / static_cast<double>(trials), 0.95 - 3.3 * std::sqrt(0.95 * 0.05 / trials));
}

}  // namespace
