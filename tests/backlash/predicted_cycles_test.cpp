// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/predicted_cycles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "backlash/describing_function.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;

// Frequency and gamma = F/(M2 clearance w^2) of the balance, solved apart from this code, to the digits given.
struct KnownPrediction {
  const char* controller;
  double restitution, omega, gamma;
};
constexpr KnownPrediction known_predictions[] = {{"1 + s", .6, 2.546479, .091193},
                                                 {"5 + s", .6, 2.546479, .255050},
                                                 {"1 + s^0.5", .6, 1.480074, .289083},
                                                 {"0.5 + s^0.7", .3, 1.040853, .390371},
                                                 {"2 + 1.5 s^0.9", .8, 6.98866753, .03908766}};

TEST(PredictedCycles, AreThoseOfTheTable) {
  for (const KnownPrediction& known : known_predictions) {
    const ControlLoop loop({1, 1, 1, known.restitution}, frac::FractionalTransferFunction::parse(known.controller));
    const std::vector<PredictedCycle> found = predicted_limit_cycles(loop);
    ASSERT_EQ(found.size(), 1U) << known.controller;
    EXPECT_NEAR(found[0].omega, known.omega, 6e-7) << known.controller;
    EXPECT_NEAR(found[0].force_amplitude / (found[0].omega * found[0].omega), known.gamma, 6e-7) << known.controller;
  }
}

// 1 + C N = 0 with N of the existing sweep of describing functions, where it shows the same orbit: stable and
// symmetric.
TEST(PredictedCycles, BalanceTheDescribingFunctionOfTheForcedMasses) {
  support::Random random(4);
  int compared = 0;
  for (int i = 0; i < 60; ++i) {
    const TwoMassSystem system(random.log_uniform(.5, 2), random.log_uniform(.5, 2), random.log_uniform(.1, 10),
                               random.uniform(.2, .9));
    const frac::FractionalTransferFunction controller(
        {{random.log_uniform(.3, 3), random.uniform(.3, 1)}, {random.log_uniform(.3, 3), 0}}, {{1, 0}},
        i % 3 == 0 ? random.uniform(.01, .3) : 0);
    const Output measured = i % 2 == 0 ? Output::x1 : Output::x2;
    const ControlLoop loop(system, controller, measured);
    for (const PredictedCycle& cycle : predicted_limit_cycles(loop)) {
      if (!cycle.faster_orbit) continue;
      SweepOptions options;
      options.protocol = Protocol::two_impact;
      options.output = measured;
      const std::vector<DescribingFunctionPoint> points =
          describing_function_sweep(system, cycle.force_amplitude, {cycle.omega}, options).points;
      if (points.front().regime != Regime::symmetric) continue;
      EXPECT_LT(std::abs(1.0 + controller.response(cycle.omega) * points.front().value), 1e-8);
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

}  // namespace
}  // namespace backlash
