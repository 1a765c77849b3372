// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <vector>

#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "support/count_allocations.hpp"

namespace {

template <typename Real>
void expect_no_allocation() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = 0.8, .mu = 0.6};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  config.goal = frac::PoleCount{15};
  config.maximum = 1;
  const frac::FractionalPidDesign first(config);
  config.gains.mu = 1.2;
  const frac::FractionalPidDesign second(config);
  frac::FractionalPid<Real> pid(config);
  const long before = support::allocations;
  Real sum = 0;
  for (int n = 0; n < 10'000; ++n) {
    const auto y = static_cast<Real>(n % 100) / 50;
    sum += pid.step(1, n % 77 == 0 ? std::numeric_limits<Real>::quiet_NaN() : y);
    if (n % 50 == 0) pid.track(y);
    if (n % 100 == 0) pid.adopt(n % 200 == 0 ? first : second);
    if (n % 1000 == 0) pid.reset();
  }
  EXPECT_EQ(support::allocations, before);
  EXPECT_NE(sum, 0);
}

TEST(FractionalPid, AllocatesNothingAfterConstruction) {
  expect_no_allocation<double>();
  expect_no_allocation<float>();
}

TEST(DigitalFilter, AllocatesNothingAfterConstruction) {
  const auto model = frac::FractionalTransferFunction::parse("exp(-0.1 s)/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  for (const auto& design :
       {filter_design(model, 0.01), filter_design(frac::digital_power(0.5, {1, 100}, frac::PoleCount{9}, 1e-3))}) {
    frac::DigitalFilter<double> filter(design);
    std::vector<double> samples(500, 1.0);
    const long before = support::allocations;
    for (int n = 0; n < 100; ++n) samples[0] = filter.step(samples[0]);
    filter.run(samples, samples);
    filter.reset();
    EXPECT_EQ(support::allocations, before);
  }
}

}  // namespace
