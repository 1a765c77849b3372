// SPDX-License-Identifier: BSD-3-Clause
// Searches under a flag that is set: each must say that it was cancelled, and not return what it has, through Ceres and
// through NLopt, which is C.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "frac/cancellation.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/tune.hpp"
#include "frac/identification/uncertainty.hpp"

namespace {

// With a disturbance of 1 %, without which some searches end before they begin.
frac::FrequencyResponseData curve() {
  const auto lag = frac::FractionalTransferFunction::parse("2/(0.5 s^0.7 + 1)");
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  for (int i = 0; i < 20; ++i) {
    omega.push_back(0.1 * (i + 1));
    value.push_back(lag.response(omega.back()) * (1 + 0.01 * std::sin(7 * i)));
  }
  return {omega, value};
}

TEST(CancelledSearches, EndAsCancelled) {
  const auto data = curve();
  const frac::Structure structure("K/(T s^a + 1)");
  const frac::FitOptions options;
  const frac::FitResult result = frac::fit(data, structure, options);
  const auto plant = frac::FractionalTransferFunction::parse("1/(s^1.5 + s)");
  const frac::LoopSpecification asked{.crossover = 1.0, .phase_margin = 1.0};

  const std::atomic<bool> flag = true;
  const frac::CancellationScope scope(flag);
  EXPECT_THROW(static_cast<void>(frac::fit(data, structure, options)), frac::Cancelled);
  EXPECT_THROW(static_cast<void>(frac::identify(data, {frac::find_model("fractional-lag")}, {}, options)),
               frac::Cancelled);
  EXPECT_THROW(static_cast<void>(frac::identify(data, {frac::find_model("rational:1..3")}, {}, options)),
               frac::Cancelled);
  EXPECT_THROW(static_cast<void>(frac::profile_interval(data, options, result, "T")), frac::Cancelled);
  EXPECT_THROW(static_cast<void>(frac::bootstrap(data, options, result, 20)), frac::Cancelled);
  EXPECT_THROW(static_cast<void>(frac::tune(plant, asked)), frac::Cancelled);
}

}  // namespace
