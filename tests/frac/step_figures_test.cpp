// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/step_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "frac/mittag_leffler.hpp"
#include "support/expect_invalid_argument.hpp"

namespace {

frac::FractionalTransferFunction model(const char* formula) {
  return frac::FractionalTransferFunction::parse(formula);
}

}  // namespace

// 1/(s^2 + 2 d s + 1) with d = 0.5: the overshoot exp(-pi d/sqrt(1 - d^2)) at pi/sqrt(1 - d^2); the settling time from
// the closed form of the error, step by step.
TEST(StepFigures, OfASecondOrderAreItsClosedForm) {
  const auto figures = frac::step_figures(model("1/(s^2 + s)"), 0.786);
  const double w = std::sqrt(0.75);
  const auto error = [&](double t) { return std::exp(-0.5 * t) * (std::cos(w * t) + 0.5 / w * std::sin(w * t)); };
  EXPECT_EQ(figures.final_value, 1);
  EXPECT_NEAR(figures.overshoot, std::exp(-std::numbers::pi * 0.5 / w), 1e-5);
  // Flat at the top: an instant's distance of 0.4 ms, and 1e-5 of the value, leave some milliseconds.
  EXPECT_NEAR(figures.peak_time, std::numbers::pi / w, 1e-2);
  double last = 0;
  for (double t = 0; t < 30; t += 1e-4)
    if (std::abs(error(t)) > 0.02) last = t;
  EXPECT_NEAR(figures.settling_time, last, 1e-3);
}

// k e^{-s}/s at k = 1/e has the double root s = -1 and does not overshoot.  At k = 1 the output is t - 1 - (t - 2)^2/2
// from 2 to 3 s, with its peak of 1.5 at 3 s.
TEST(StepFigures, OfAnIntegratorWithDeadTimeAreItsPolynomials) {
  const auto critical = frac::step_figures(model("exp(-1 s)*0.36787944117144233/s"), 0.368);
  EXPECT_LT(critical.overshoot, 1e-4);
  const auto ringing = frac::step_figures(model("exp(-1 s)/s"), 1);
  EXPECT_NEAR(ringing.overshoot, 0.5, 1e-4);
  EXPECT_NEAR(ringing.peak_time, 3, 1e-2);
}

// A lag under a gain ends at K/(1 + K) and does not pass it; s^0.2 takes its time: 1 - E_{0.2}(-t^0.2), which is
// outside of 2 % for e-folds by the hundred.
TEST(StepFigures, TellWhatIsNotReached) {
  const auto lag = frac::step_figures(model("3/(s + 1)"), 2.8);
  EXPECT_NEAR(lag.final_value, 0.75, 1e-15);
  EXPECT_EQ(lag.overshoot, 0);
  EXPECT_TRUE(std::isnan(lag.peak_time));
  // e^{-4 t} = 0.02, to the tolerance of 1e-5 over the slope of 0.08/s.
  EXPECT_NEAR(lag.settling_time, std::log(50.0) / 4, 1e-3);
  EXPECT_TRUE(std::isnan(frac::step_figures(model("1/s^0.2"), 1).settling_time));
  support::expect_invalid_argument([] { (void)frac::step_figures(model("1/s"), 0); }, {"crossover = 0"});
}

// Orders without a common divisor: the closed loop is no simpler than it looks, and nobody looks for common factors by
// long division, which would take minutes.  The peak of 1/(s^1.8311 + 1), the figure of s^-1.8311, is that of
// 1 - E_{1.8311}(-t^1.8311): from its first minimum, on a grid of a thousandth.
TEST(StepFigures, TakeNoTimeForOrdersWithoutCommonDivisor) {
  const auto figures = frac::step_figures(model("1/s^1.8311"), 1);
  double highest = 0;
  for (double t = 2; t < 5; t += 1e-3)
    highest = std::max(highest, -frac::mittag_leffler(1.8311, 1.0, -std::pow(t, 1.8311)));
  EXPECT_NEAR(figures.overshoot, highest, 2e-5);
  const auto start = std::chrono::steady_clock::now();
  const auto heavy =
      frac::step_figures(model("(1.3 + 0.2/s^0.731 + 0.8 s^0.917)*(s^1.4713 + 3.1)/(s^2 (s^1.4713 + 1.827))"), 1.3);
  EXPECT_GT(heavy.overshoot, 0);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 20);
}
