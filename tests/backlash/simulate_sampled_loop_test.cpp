// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_sampled_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "backlash/loops/limit_cycles.hpp"
#include "support/expect_invalid_argument.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;

ControlLoop loop_of(const std::string& controller, double restitution, Output measured = Output::x1) {
  return {{1, 1, 1, restitution}, frac::FractionalTransferFunction::parse(controller), measured};
}

// Mean half period over the last forty zeros of x1, which is linear in time between impacts.
double half_period(const SampledLoopHistory& history) {
  std::vector<double> zeros;
  for (std::size_t i = 1; i < history.rows.size(); ++i) {
    const LoopRow &a = history.rows[i - 1], &b = history.rows[i];
    if ((a.x1 > 0) != (b.x1 > 0)) zeros.push_back(a.time + (b.time - a.time) * a.x1 / (a.x1 - b.x1));
  }
  EXPECT_GT(zeros.size(), 60U);
  return zeros.size() > 60 ? (zeros.back() - zeros[zeros.size() - 41]) / 40 : NAN;
}

SampledLoopOptions options_of(double sample_time, double duration) {
  SampledLoopOptions options;
  options.sample_time = sample_time;
  options.duration = duration;
  options.velocity1 = .1;
  options.velocity2 = 1;
  return options;
}

// The held force and the difference quotient delay the controller by about a sample, so that the half period of the
// sampled loop, 1 s in the continuous one, differs by some samples and by the first power of the sample time.
TEST(SimulateSampledLoop, TendsToTheExactCycle) {
  const ControlLoop loop = loop_of("1 + s", .6);
  const double exact = pi / symmetric_cycles(loop).cycles.front().omega;
  const double coarse = half_period(simulate_sampled_loop(loop, options_of(4e-3, 120))) - exact;
  const double fine = half_period(simulate_sampled_loop(loop, options_of(2e-3, 120))) - exact;
  EXPECT_LT(std::abs(fine), 8e-3);
  EXPECT_NEAR(coarse / fine, 2, .3);
}

// Samples of 1 ms leave some of them in the half period of 2 s, as above, and the filter of s^0.5 a thousandth.
TEST(SimulateSampledLoop, HasTheCycleOfAFractionalController) {
  const ControlLoop loop = loop_of("1 + s^0.5", .6);
  const double exact = pi / symmetric_cycles(loop).cycles.front().omega;
  EXPECT_NEAR(half_period(simulate_sampled_loop(loop, options_of(1e-3, 160))), exact, .005 * exact);
}

// What the continuous simulation does not follow: a limit of the force, restitution 0 with its rests in contact, and
// the driven body measured.  The force keeps its limit, the gap its walls, and without an impact the momentum is the
// force's.
TEST(SimulateSampledLoop, KeepsLimitsWallsAndMomentum) {
  for (const Output measured : {Output::x1, Output::x2}) {
    for (const double restitution : {0.0, .6}) {
      SampledLoopOptions options = options_of(1e-3, 30);
      options.force_limit = .2;
      options.set_point.step = .3;
      const SampledLoopHistory history =
          simulate_sampled_loop(loop_of("exp(-0.02 s) (1 + 0.1/s + s)", restitution, measured), options);
      EXPECT_GT(history.impacts, 2U);
      double momentum = options.velocity1 + options.velocity2;
      for (const LoopRow& row : history.rows) {
        EXPECT_LE(std::abs(row.force), .2);
        EXPECT_LE(std::abs(row.x2 - row.x1), .5 + 1e-12);
        EXPECT_NEAR(row.v1 + row.v2, momentum, 1e-10);
        momentum += row.force * 1e-3;
      }
      // Twenty samples go by before the controller is heard.
      EXPECT_EQ(history.rows[19].force, 0);
      EXPECT_NE(history.rows[20].force, 0);
    }
  }
}

// A cascade in a computer tends to the cascade whose force is not held: behind the limit both clamp the same sum, and
// the held force and the difference quotient differ from the continuous ones by the first power of the sample time.
TEST(SimulateSampledLoop, ACascadeTendsToTheContinuousOne) {
  const ControlLoop loop = loop_of("(2 + s) (1.5 + 0.75/s)", .5, Output::x2);
  LoopSimulationOptions exact;
  exact.duration = 4;
  exact.sample_time = 4;
  exact.rows_at_impacts = false;
  exact.disturbance.body2 = -.2;
  SetPoint set_point{1, 0, 0, 0, {}, .5};
  const double wanted = simulate_loop(loop, {}, set_point, exact).rows.back().x2;
  std::vector<double> errors;
  for (const double sample_time : {4e-3, 2e-3, 1e-3}) {
    SampledLoopOptions options;
    options.sample_time = sample_time;
    options.duration = 4;
    options.set_point = set_point;
    options.disturbance.body2 = -.2;
    errors.push_back(simulate_sampled_loop(loop, options).rows.back().x2 - wanted);
  }
  // Of second order is what halves with each doubling.
  EXPECT_NEAR(errors[0] / errors[1], 2, .1);
  EXPECT_NEAR(errors[1] / errors[2], 2, .05);
  EXPECT_LT(std::abs(errors[2]), 5e-3);
}

// A gain alone makes a force of what the encoder reads: whole steps, half a step off the position at most.
TEST(SimulateSampledLoop, ReadsWholeStepsOfItsEncoder) {
  SampledLoopOptions options = options_of(.01, 5);
  options.encoder_step = 1.0 / 64;
  for (const Output measured : {Output::x1, Output::x2}) {
    for (const LoopRow& row : simulate_sampled_loop(loop_of("2", .6, measured), options).rows) {
      const double read = -row.force / 2, position = measured == Output::x1 ? row.x1 : row.x2;
      EXPECT_EQ(read * 64, std::round(read * 64));
      EXPECT_LE(std::abs(read - position), .5 / 64);
    }
  }
}

TEST(SimulateSampledLoop, RefusesWhatItDoesNotRun) {
  const auto run = [](const ControlLoop& loop, const SampledLoopOptions& options) {
    (void)simulate_sampled_loop(loop, options);
  };
  support::expect_invalid_argument([&] { run(loop_of("1 + s", .6), {}); }, {"sample time"});
  support::expect_invalid_argument([&] { run(loop_of("1/(s + 1)", .6), options_of(.01, 1)); }, {"kp + ki/s^lambda"});
  support::expect_invalid_argument([&] { run(loop_of("1 + s + s^0.5", .6), options_of(.01, 1)); }, {"other terms"});
  support::expect_invalid_argument([&] { run(loop_of("1 + s", .6), options_of(1e-8, 1)); }, {"samples"});
  SampledLoopOptions lagged = options_of(.01, 1);
  lagged.set_point = {1, 0, 0, 0, {}, .5};
  support::expect_invalid_argument([&] { run(loop_of("1 + s", .6), lagged); }, {"lag", "cascade"});
}

}  // namespace
}  // namespace backlash
