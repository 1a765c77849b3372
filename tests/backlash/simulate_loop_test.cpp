// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "backlash/loops/limit_cycles.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

constexpr double pi = std::numbers::pi;

ControlLoop loop_of(const std::string& controller, double restitution) {
  return {{1, 1, 1, restitution}, frac::FractionalTransferFunction::parse(controller)};
}

LoopHistory impacts_of(const ControlLoop& loop, const LoopStart& start, std::size_t most) {
  LoopSimulationOptions options;
  options.duration = 1e5;
  options.most_impacts = most;
  return simulate_loop(loop, start, {}, options);
}

double half_period(const LoopHistory& history, std::size_t from_the_end) {
  const std::size_t last = history.impacts.size() - 1 - from_the_end;
  return history.impacts[last].time - history.impacts[last - 1].time;
}

// Stable cycles attract.  Without memory disturbances die out geometrically; with it as a power of time, after 400
// impacts to about 1e-7.  Rounding at t = 300 is that of 300 terms of size kp t^2.
TEST(SimulateLoop, SettlesOnTheExactCycle) {
  const struct {
    const char* controller;
    double restitution, tolerance;
  } cases[] = {{"1 + s", .6, 1e-7}, {"5 + s", .6, 1e-7}, {"1 + s^0.5", .6, 2e-7}, {"2 + 1.5 s^0.9", .8, 2e-6}};
  for (const auto& each : cases) {
    const ControlLoop loop = loop_of(each.controller, each.restitution);
    const SymmetricCycle cycle = symmetric_cycles(loop).cycles.front();
    const LoopHistory history = impacts_of(loop, {0, .1, 0, 1}, 300);
    ASSERT_EQ(history.impacts.size(), 300U) << each.controller;
    EXPECT_NEAR(half_period(history, 0), pi / cycle.omega, each.tolerance) << each.controller;
    EXPECT_NEAR(half_period(history, 1), pi / cycle.omega, each.tolerance) << each.controller;
    EXPECT_NEAR(history.impacts.back().speed, cycle.impact_speed, 10 * each.tolerance) << each.controller;
  }
}

// Where symmetry is lost the motion goes to an asymmetric cycle, whose half periods are known to the digits given.
TEST(SimulateLoop, GoesToTheAsymmetricCycle) {
  const LoopHistory history = impacts_of(loop_of("20 + s", .6), {0, .1, 0, 5}, 400);
  ASSERT_EQ(history.impacts.size(), 400U);
  const double longer = std::max(half_period(history, 0), half_period(history, 1));
  const double shorter = std::min(half_period(history, 0), half_period(history, 1));
  EXPECT_NEAR(longer, .51285064, 3e-7);
  EXPECT_NEAR(shorter, .38239689, 3e-7);
}

// A quadrature of the double integral of the force, apart from the closed form of the position: midpoint rule in both
// integrals, which errs by the square of the step, and an order below 1 leaves no singularity that matters.
TEST(SimulateLoop, FollowsNewtonsLawBetweenImpacts) {
  const ControlLoop loop({1, 2, 100, .6},
                         frac::FractionalTransferFunction::parse("exp(-0.3 s) (0.5 + 0.4 s^0.6 + 0.1/s)"));
  LoopSimulationOptions options;
  options.duration = 4;
  options.sample_time = 1e-3;
  const LoopHistory history = simulate_loop(loop, {0, .2, 0, -.1}, {0, .3}, options);
  ASSERT_EQ(history.impacts.size(), 0U);
  ASSERT_EQ(history.rows.size(), 4001U);
  double velocity = -.1;
  for (std::size_t i = 1; i < history.rows.size(); ++i) {
    velocity += 1e-3 * 0.5 * (history.rows[i].force + history.rows[i - 1].force) / 2;
  }
  EXPECT_NEAR(history.rows.back().v2, velocity, 1e-5);
  double position = 0;
  for (std::size_t i = 1; i < history.rows.size(); ++i) {
    position += 1e-3 * 0.5 * (history.rows[i].v2 + history.rows[i - 1].v2);
  }
  EXPECT_NEAR(history.rows.back().x2, position, 1e-6);
  EXPECT_DOUBLE_EQ(history.rows.back().x1, .8);
}

// Impacts keep momentum and restitution, happen at the walls, and between them the masses stay inside.
TEST(SimulateLoop, MeetsTheWallsAndNothingElse) {
  support::Random random(5);
  int impacts = 0;
  for (int i = 0; i < 40; ++i) {
    const TwoMassSystem system(random.log_uniform(.3, 3), random.log_uniform(.3, 3), random.log_uniform(.1, 10),
                               random.uniform(.3, 1));
    const double delay = i % 3 == 0 ? random.uniform(.01, .5) : 0;
    const ControlLoop loop(
        system,
        frac::FractionalTransferFunction(
            {{random.log_uniform(.1, 3), random.uniform(.2, 1.5)}, {random.log_uniform(.1, 3), 0}}, {{1, 0}}, delay));
    LoopSimulationOptions options;
    options.duration = 30;
    options.sample_time = .01;
    options.most_impacts = 60;
    const double half = system.clearance() / 2;
    const LoopHistory history = simulate_loop(loop, {0, 0, half / 2, system.clearance()}, {}, options);
    for (std::size_t k = 0; k < history.rows.size(); ++k) {
      const LoopRow& row = history.rows[k];
      EXPECT_LE(std::abs(row.x2 - row.x1), half * (1 + 1e-9) + 1e-12 * std::abs(row.x1));
      if (row.event != LoopEvent::after_impact) continue;
      const LoopRow& before = history.rows[k - 1];
      EXPECT_NEAR(std::abs(row.x2 - row.x1), half, 1e-9 * half + 1e-12 * std::abs(row.x1));
      EXPECT_NEAR(row.v2 - row.v1, -system.restitution() * (before.v2 - before.v1), 1e-9);
      EXPECT_NEAR(system.mass1() * row.v1 + system.mass2() * row.v2,
                  system.mass1() * before.v1 + system.mass2() * before.v2, 1e-9);
      ++impacts;
    }
  }
  EXPECT_GT(impacts, 500);
}

// Seeded loops of proportional and derivative action, without memory: a stable cycle holds a small disturbance, an
// unstable one loses it.  The start is the state of the cycle just after an impact, moved a little.
TEST(SimulateLoop, AgreesWithTheStabilityOfCycles) {
  support::Random random(6);
  int stable = 0, unstable = 0;
  for (int i = 0; i < 160; ++i) {
    const double kp = random.log_uniform(1, 40), kd = random.log_uniform(.3, 3);
    const ControlLoop loop({1, random.log_uniform(.5, 2), 1, random.uniform(.2, .8)},
                           frac::FractionalTransferFunction({{kd, 1}, {kp, 0}}, {{1, 0}}));
    LimitCycleOptions request;
    request.harmonics = 1;
    const LimitCycles found = symmetric_cycles(loop, request);
    const SymmetricCycle& cycle = found.cycles.front();
    const double modulus = std::abs(cycle.stability.dominant);
    if (!cycle.admissible || std::abs(modulus - 1) < .03) continue;
    // x1 is a triangle wave that turns at the impacts: its speed is I/(2 M1).
    const double tau = pi / cycle.omega;
    const double v1 = cycle.impulse / (2 * loop.system().mass1());
    const double x1 = -v1 * tau / 2;
    const double v2 = v1 - loop.system().restitution() * cycle.impact_speed;
    LoopStart start{x1, v1, x1 + .5, v2 * (1 + 1e-4)};
    start.x2 = std::nextafter(start.x2, x1);
    const LoopHistory history = impacts_of(loop, start, 150);
    if (history.impacts.size() < 150) {
      EXPECT_FALSE(cycle.stability.stable) << i;
      continue;
    }
    const double distance = std::abs(half_period(history, 0) / tau - 1) + std::abs(half_period(history, 1) / tau - 1);
    EXPECT_EQ(distance < 1e-4, cycle.stability.stable) << i << ": " << loop.controller().formula() << ' ' << modulus;
    (cycle.stability.stable ? stable : unstable) += 1;
  }
  EXPECT_GT(stable, 30);
  EXPECT_GT(unstable, 5);
}

TEST(SimulateLoop, RefusesWhatItDoesNotFollow) {
  const ControlLoop loop = loop_of("1 + s^0.5", .6);
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {0, 0, .6, 0}, {}); }, {"0.6", "0.5"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1 + s^1.2", .6), {}, {1, 0}); }, {"s^1.2"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1/(s + 1)", .6), {}, {}); }, {"sum of powers"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1 + s", 0), {}, {}); }, {"restitution 0"});
  const frac::FractionalTransferFunction damped = frac::FractionalTransferFunction::parse("1/(s^2 + s)");
  const ControlLoop with_friction(LinearBodies(damped, free_mass(1), 1, .6), loop.controller());
  support::expect_invalid_argument([&] { (void)simulate_loop(with_friction, {}, {}); }, {"free masses"});
  LoopSimulationOptions options;
  options.duration = -1;
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {}, options); }, {"duration"});
}

}  // namespace
}  // namespace backlash
