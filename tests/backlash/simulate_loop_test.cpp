// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "backlash/loops/impact_cycles.hpp"
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
  EXPECT_NEAR(history.rows.back().x1, .8, 1e-11);
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
      // A bounce that leaves the wall by less than the rounding of positions, v^2/(2 a) of some 1e-15, is not followed.
      const double followed = row.v2 == row.v1 ? 1e-6 : 1e-9;
      EXPECT_NEAR(row.v2 - row.v1, -system.restitution() * (before.v2 - before.v1), followed);
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
  for (int i = 0; i < 500; ++i) {
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
  EXPECT_GT(stable, 100);
  EXPECT_GT(unstable, 15);
}

// A loop of whole powers, integrated in small steps by the classical method of fourth order: an impact within a step is
// found by halving it, and contact ends where the wall would have to pull.
class SmallSteps {
 public:
  struct Scene {
    double mass1 = 1, mass2 = 1, friction1 = 0, spring1 = 0, friction2 = 0, spring2 = 0;
    double kp = 0, ki = 0, kd = 0;
    bool measures_x2 = false;
    double clearance = 1, restitution = .6, limit = 1e300;
    SetPoint set_point = {};
    // Above 0: the integral and the derivative are of the speed error, position_gain times that of the position less
    // the speed, as in a position controller around a speed controller.
    double position_gain = 0;
    Disturbance disturbance = {};
  };
  struct State {
    double x1, v1, x2, v2, integral;
  };

  SmallSteps(Scene scene, State start) : scene_(scene), state_(start) {}
  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] int impacts() const { return impacts_; }
  [[nodiscard]] int contacts() const { return contacts_; }

  void advance_to(double time, double step) {
    while (time_ < time - 1e-12) {
      double left = std::min(step, time - time_);
      State next = stepped(left);
      if (wall_ == 0 ? std::abs(next.x2 - next.x1) > scene_.clearance / 2 : wall_ * pressing(next, time_ + left) < 0) {
        double low = 0, high = left;
        for (int i = 0; i < 50; ++i) {
          const double middle = (low + high) / 2;
          const State at = stepped(middle);
          const bool beyond =
              wall_ == 0 ? std::abs(at.x2 - at.x1) > scene_.clearance / 2 : wall_ * pressing(at, time_ + middle) < 0;
          (beyond ? high : low) = middle;
        }
        next = stepped(low);
        left = low;
        time_ += left;
        state_ = next;
        if (wall_ != 0) {
          wall_ = 0;
          // On, so that it has left the wall.
          state_ = stepped(1e-7);
          time_ += 1e-7;
          continue;
        }
        hit();
        continue;
      }
      state_ = next;
      time_ += left;
    }
  }

 private:
  [[nodiscard]] double force(const State& s, double time) const {
    const double sine = scene_.set_point.sine_omega * time;
    const double position =
        scene_.set_point.step + scene_.set_point.ramp * time + scene_.set_point.sine_amplitude * std::sin(sine);
    const double rate =
        scene_.set_point.ramp + scene_.set_point.sine_amplitude * scene_.set_point.sine_omega * std::cos(sine);
    const double error = position - (scene_.measures_x2 ? s.x2 : s.x1);
    const double error_rate =
        scene_.position_gain > 0 ? speed_error(s, error) : rate - (scene_.measures_x2 ? s.v2 : s.v1);
    return std::clamp(scene_.kp * error + scene_.ki * s.integral + scene_.kd * error_rate, -scene_.limit, scene_.limit);
  }
  [[nodiscard]] double speed_error(const State& s, double error) const {
    return scene_.position_gain * error - (scene_.measures_x2 ? s.v2 : s.v1);
  }
  // Forces on the bodies but that of the wall.
  [[nodiscard]] double load(const State& s) const {
    return scene_.disturbance.body1 - scene_.friction1 * s.v1 - scene_.spring1 * s.x1;
  }
  [[nodiscard]] double drive(const State& s, double time) const {
    return force(s, time) + scene_.disturbance.body2 - scene_.friction2 * s.v2 - scene_.spring2 * s.x2;
  }
  // Of the wall on mass 1 in contact.
  [[nodiscard]] double pressing(const State& s, double time) const {
    const double together = (load(s) + drive(s, time)) / (scene_.mass1 + scene_.mass2);
    return scene_.mass1 * together - load(s);
  }
  [[nodiscard]] State rate(const State& s, double time) const {
    const double position = scene_.set_point.step + scene_.set_point.ramp * time +
                            scene_.set_point.sine_amplitude * std::sin(scene_.set_point.sine_omega * time);
    const double distance = position - (scene_.measures_x2 ? s.x2 : s.x1);
    const double error = scene_.position_gain > 0 ? speed_error(s, distance) : distance;
    if (wall_ == 0) return {s.v1, load(s) / scene_.mass1, s.v2, drive(s, time) / scene_.mass2, error};
    const double together = (load(s) + drive(s, time)) / (scene_.mass1 + scene_.mass2);
    return {s.v1, together, s.v2, together, error};
  }
  [[nodiscard]] State stepped(double h) const {
    const auto moved = [](const State& s, const State& by, double t) {
      return State{s.x1 + t * by.x1, s.v1 + t * by.v1, s.x2 + t * by.x2, s.v2 + t * by.v2,
                   s.integral + t * by.integral};
    };
    const State a = rate(state_, time_);
    const State b = rate(moved(state_, a, h / 2), time_ + h / 2);
    const State c = rate(moved(state_, b, h / 2), time_ + h / 2);
    const State d = rate(moved(state_, c, h), time_ + h);
    return moved(moved(moved(moved(state_, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  void hit() {
    const double speed = state_.v2 - state_.v1;
    const double impulse = (1 + scene_.restitution) * speed / (1 / scene_.mass1 + 1 / scene_.mass2);
    state_.v1 += impulse / scene_.mass1;
    state_.v2 -= impulse / scene_.mass2;
    ++impacts_;
    const double wall = state_.x2 > state_.x1 ? 1 : -1;
    if (std::abs(state_.v2 - state_.v1) > 1e-7 || wall * pressing(state_, time_) < 0) return;
    const double common = (scene_.mass1 * state_.v1 + scene_.mass2 * state_.v2) / (scene_.mass1 + scene_.mass2);
    state_.v1 = state_.v2 = common;
    state_.x2 = state_.x1 + wall * scene_.clearance / 2;
    wall_ = wall;
    ++contacts_;
  }

  Scene scene_;
  State state_;
  double time_ = 0;
  double wall_ = 0;
  int impacts_ = 0;
  int contacts_ = 0;
};

// Steps of 1/2000 s err by about 1e-13 each; a limit that is met within one, and a chatter that is ended at 1e-7 m/s,
// by 1e-7.  Errors grow by the multipliers of the impacts, for which 10 s leave a factor of a few.
TEST(SimulateLoop, IsWhatSmallStepsGive) {
  using Scene = SmallSteps::Scene;
  struct Case {
    Scene scene;
    std::string controller, load, drive;
    bool rests;
  };
  const Case cases[] = {
      {{.friction1 = .1, .spring1 = .3, .friction2 = .2, .kp = 2, .kd = 1},
       "2 + s",
       "1/(s^2 + 0.1 s + 0.3)",
       "1/(s^2 + 0.2 s)",
       false},
      {{.mass2 = 2, .kp = 3, .ki = .4, .kd = 1, .set_point = {.3, .1, .5, .7, {}}},
       "3 + 0.4/s + s",
       "1/s^2",
       "1/(2 s^2)",
       false},
      {{.friction2 = .5,
        .kp = 4,
        .ki = 1,
        .kd = .5,
        .measures_x2 = true,
        .restitution = .8,
        .set_point = {0, 0, 1, 1.3, {}}},
       "4 + 1/s + 0.5 s",
       "1/s^2",
       "1/(s^2 + 0.5 s)",
       false},
      {{.kp = 1, .kd = 1, .restitution = 0}, "1 + s", "1/s^2", "1/s^2", true},
      {{.mass1 = .2,
        .friction1 = .3,
        .kp = 5,
        .kd = 1,
        .restitution = .4,
        .limit = .5,
        .set_point = {.5, .1, 0, 0, {}}},
       "5 + s",
       "1/(0.2 s^2 + 0.3 s)",
       "1/s^2",
       true},
      {{.kp = 1, .kd = 1, .limit = .3}, "1 + s", "1/s^2", "1/s^2", false},
      // Cascades of 2/s, 1.5 N s/m and 2 s, whose lag is 1/2 s, and forces that disturb.
      {{.mass2 = 2, .ki = .75, .kd = 1.5, .set_point = {.5, .2, 0, 0, {}, .5}, .position_gain = 2},
       "(2 + s) (1.5 + 0.75/s)",
       "1/s^2",
       "1/(2 s^2)",
       false},
      {{.friction1 = .2,
        .ki = .75,
        .kd = 1.5,
        .measures_x2 = true,
        .restitution = .3,
        .set_point = {1, 0, .3, 1.1, {}, .5},
        .position_gain = 2,
        .disturbance = {-.3, .2}},
       "(2 + s) (1.5 + 0.75/s)",
       "1/(s^2 + 0.2 s)",
       "1/s^2",
       true},
      {{.kd = 1.5, .limit = .6, .set_point = {1, 0, 0, 0, {}, .5}, .position_gain = 2, .disturbance = {.1, -.15}},
       "1.5 (2 + s)",
       "1/s^2",
       "1/s^2",
       false},
  };
  for (const Case& each : cases) {
    const Scene& scene = each.scene;
    const ControlLoop loop(
        LinearBodies(frac::FractionalTransferFunction::parse(each.load),
                     frac::FractionalTransferFunction::parse(each.drive), scene.clearance, scene.restitution),
        frac::FractionalTransferFunction::parse(each.controller), scene.measures_x2 ? Output::x2 : Output::x1);
    LoopSimulationOptions options;
    options.duration = 10;
    options.sample_time = .1;
    options.rows_at_impacts = false;
    options.force_limit = scene.limit < 1e299 ? scene.limit : std::numeric_limits<double>::infinity();
    options.disturbance = scene.disturbance;
    const LoopHistory history = simulate_loop(loop, {0, .1, 0, 1}, scene.set_point, options);
    EXPECT_EQ(history.end, LoopEnd::duration) << each.controller;
    EXPECT_EQ(history.realisation_error, 0);
    ASSERT_EQ(history.rows.size(), 101U);
    // A derivative that meets the step of the set-point kicks mass 2, unless the actuator is limited.
    const double kick =
        scene.limit < 1e299 || scene.position_gain > 0 ? 0 : scene.kd * scene.set_point.step / scene.mass2;
    SmallSteps steps(scene, {0, .1, 0, 1 + kick, 0});
    double largest = 0;
    for (const LoopRow& row : history.rows) {
      steps.advance_to(row.time, 1.0 / 2000);
      const SmallSteps::State& state = steps.state();
      EXPECT_NEAR(row.x1, state.x1, 2e-5) << each.controller << " at " << row.time;
      EXPECT_NEAR(row.x2, state.x2, 2e-5) << each.controller << " at " << row.time;
      largest = std::max(largest, std::abs(row.force));
    }
    EXPECT_EQ(steps.contacts() > 0, each.rests) << each.controller;
    EXPECT_GE(steps.impacts(), 3) << each.controller;
    if (scene.limit < 1) {
      EXPECT_EQ(largest, scene.limit) << each.controller;
    }
  }
}

// The two ways have nothing in common but the law of impact.  Exponentials err by the tolerance in the force on the
// band of the motion and by more below it, where the start has its share; a motion of 40 impacts remembers it all the
// way.
TEST(SimulateLoop, ExponentialsAreTheWholeMemory) {
  const char* const controllers[] = {"1 + s^0.5",
                                     "2 + 1.5 s^0.9",
                                     "1 + s^0.5 + 0.3/s^0.6",
                                     "1 + s^1.3",
                                     "0.5 + s^0.05 + 0.4 s",
                                     "exp(-0.1 s) (1 + s^0.5)",
                                     "exp(-3 s) (0.1 s^0.2)"};
  for (const char* controller : controllers) {
    const ControlLoop loop = loop_of(controller, .7);
    LoopSimulationOptions options;
    options.duration = 60;
    options.most_impacts = 40;
    options.whole_memory = true;
    const LoopHistory exact = simulate_loop(loop, {.2, .1, 0, 1}, {0, .01}, options);
    options.whole_memory = false;
    for (const double tolerance : {1e-5, 1e-9}) {
      options.tolerance = tolerance;
      const LoopHistory history = simulate_loop(loop, {.2, .1, 0, 1}, {0, .01}, options);
      EXPECT_LT(history.realisation_error, 30 * tolerance) << controller;
      EXPECT_GT(history.realisation_error, 0) << controller;
      ASSERT_EQ(history.impacts.size(), exact.impacts.size()) << controller;
      for (std::size_t i = 0; i < exact.impacts.size(); ++i) {
        EXPECT_NEAR(history.impacts[i].time, exact.impacts[i].time, 1000 * tolerance) << controller << ' ' << i;
        EXPECT_NEAR(history.impacts[i].speed, exact.impacts[i].speed, 1000 * tolerance) << controller << ' ' << i;
      }
    }
  }
}

// The series of the cycle know no time; the motion comes to them but for what the memory still holds after 400 impacts.
TEST(SimulateLoop, SettlesOnTheCycleOfAnyLoop) {
  const struct {
    ControlLoop loop;
    double tolerance;
  } cases[] = {
      {loop_of("(2 + s + 0.1 s^0.5)/(0.05 s + 1)", .6), 1e-6},
      {{{1, 2, 1, .6}, frac::FractionalTransferFunction::parse("(1 + s^0.7)/(0.3 s^0.5 + 1)")}, 1e-5},
      {{LinearBodies(frac::FractionalTransferFunction::parse("1/(s^2 + 0.1 s + 0.3)"),
                     frac::FractionalTransferFunction::parse("1/(s^2 + 0.2 s)"), 1, .6),
        frac::FractionalTransferFunction::parse("2 + s")},
       1e-9},
      {{LinearBodies(frac::FractionalTransferFunction::parse("1/(s^2 + 0.2 s^0.5)"), free_mass(2), .5, .7),
        frac::FractionalTransferFunction::parse("3 + s^0.8")},
       3e-5},
  };
  for (const auto& [loop, tolerance] : cases) {
    const SymmetricCycle cycle = symmetric_cycles(loop).cycles.back();
    ASSERT_TRUE(cycle.admissible && cycle.stability.stable) << loop.controller().formula();
    const LoopHistory history =
        impacts_of(loop, {0, 0, 0, loop.bodies().has_free_load() ? .8 * cycle.impact_speed : cycle.impact_speed}, 400);
    ASSERT_EQ(history.impacts.size(), 400U) << loop.controller().formula();
    EXPECT_NEAR(half_period(history, 0) * cycle.omega / pi, 1, tolerance) << loop.controller().formula();
    EXPECT_NEAR(history.impacts.back().speed / cycle.impact_speed, 1, tolerance) << loop.controller().formula();
  }
}

// A spring from the driven body to the ground and impacts without loss keep the energy.  10^5 impacts round by a few
// 1e-16 each, some of it one way.
TEST(SimulateLoop, KeepsTheEnergyOfALoopWithoutLoss) {
  const ControlLoop loop({1, 3, 1, 1}, frac::FractionalTransferFunction::parse("4"), Output::x2);
  LoopSimulationOptions options;
  options.duration = 1e9;
  options.most_impacts = 100'000;
  const LoopHistory history = simulate_loop(loop, {0, 0, 0, 1}, {}, options);
  ASSERT_EQ(history.impacts.size(), 100'000U);
  for (const std::size_t i : {std::size_t{1}, history.rows.size() / 2, history.rows.size() - 1}) {
    const LoopRow& row = history.rows[i];
    EXPECT_NEAR(row.v1 * row.v1 + 3 * row.v2 * row.v2 + 4 * row.x2 * row.x2, 3, 1e-11) << i;
  }
}

// The controller gives what each impact of the cycle takes, however long it runs.
TEST(SimulateLoop, DoesNotDriftOverManyImpacts) {
  const ControlLoop loop = loop_of("1 + s", .6);
  const SymmetricCycle cycle = symmetric_cycles(loop).cycles.front();
  LoopSimulationOptions options;
  options.duration = 1e9;
  options.most_impacts = 300'000;
  options.rows_at_impacts = false;
  const LoopHistory history = simulate_loop(loop, {0, .1, 0, 1}, {}, options);
  ASSERT_EQ(history.impacts.size(), 300'000U);
  double worst = 0;
  for (std::size_t i = 1000; i < history.impacts.size(); ++i) {
    worst = std::max(worst, std::abs(history.impacts[i].speed / cycle.impact_speed - 1));
  }
  EXPECT_LT(worst, 1e-12);
}

// Two fractional powers of one controller share the rates of their exponentials, which then come as eigenvalues that
// hardly differ.  Rows do not change the motion, however many flights they make of one.
TEST(SimulateLoop, IsTheSameInManyShortFlights) {
  for (const char* controller : {"1 + s^0.5 + 0.3/s^0.6", "1 + s^0.5 + s^0.3", "1 + s^1.5 + 0.2 s^0.5"}) {
    for (const double tolerance : {1e-8, 1e-9, 1e-10}) {
      LoopSimulationOptions options;
      options.duration = 2;
      options.tolerance = tolerance;
      const ControlLoop loop = loop_of(controller, .05);
      const LoopHistory once = simulate_loop(loop, {0, 0, 0, 1}, {}, options);
      options.sample_time = 1e-3;
      const LoopHistory often = simulate_loop(loop, {0, 0, 0, 1}, {}, options);
      ASSERT_FALSE(once.impacts.empty());
      ASSERT_GE(often.impacts.size(), 1U);
      EXPECT_EQ(often.end, LoopEnd::duration) << controller << ' ' << tolerance;
      // The first two impacts; what follows a chatter may have bounces more or fewer.
      for (std::size_t i = 0; i < std::min<std::size_t>(2, once.impacts.size()); ++i) {
        EXPECT_NEAR(often.impacts[i].time, once.impacts[i].time, 1e-7) << controller << ' ' << tolerance;
        EXPECT_NEAR(often.impacts[i].speed, once.impacts[i].speed, 1e-7) << controller << ' ' << tolerance;
      }
    }
  }
}

TEST(SimulateLoop, FollowsALineOfPoints) {
  const ControlLoop loop = loop_of("2 + s^0.5 + 0.1/s", .5);
  LoopSimulationOptions options;
  options.duration = 3;
  options.sample_time = .1;
  const LoopHistory ramp = simulate_loop(loop, {}, {0, .4}, options);
  const LoopHistory line = simulate_loop(loop, {}, {0, 0, 0, 0, {{0, 0}, {1, .4}, {2, .8}, {3.5, 1.4}}}, options);
  ASSERT_EQ(ramp.rows.size(), line.rows.size());
  ASSERT_GT(ramp.impacts.size(), 0U);
  for (std::size_t i = 0; i < ramp.rows.size(); ++i) EXPECT_NEAR(ramp.rows[i].x2, line.rows[i].x2, 1e-11);
  // A step and a point at its height are one, and after the last point the line stays.
  const LoopHistory step = simulate_loop(loop, {}, {.7, 0}, options);
  const LoopHistory points = simulate_loop(loop, {}, {0, 0, 0, 0, {{0, .7}, {.5, .7}}}, options);
  ASSERT_EQ(step.rows.size(), points.rows.size());
  for (std::size_t i = 0; i < step.rows.size(); ++i) EXPECT_NEAR(step.rows[i].x1, points.rows[i].x1, 1e-11);
}

TEST(SimulateLoop, HardScenesEndWithTheirReason) {
  const auto end_of = [](const ControlLoop& loop, double duration = 50) {
    LoopSimulationOptions options;
    options.duration = duration;
    const LoopHistory history = simulate_loop(loop, {0, .1, 0, 1}, {}, options);
    for (const LoopRow& row : history.rows) EXPECT_TRUE(std::isfinite(row.x1 + row.x2 + row.v1 + row.v2));
    return history;
  };
  // A pure integral drives the rigid loop apart.
  EXPECT_EQ(end_of(loop_of("3/s", .6), 200).end, LoopEnd::diverged);
  // No stiffness: the masses drift, and friction of the controller brings them to rest.
  EXPECT_EQ(end_of(loop_of("0 + s", .6)).end, LoopEnd::duration);
  // A dead time much longer than the cycle without it.
  EXPECT_GT(end_of(loop_of("exp(-12 s) (1 + s)", .6)).impacts.size(), 2U);
  for (const char* controller : {"1 + s^0.01", "1 + 0.1 s^1.99", "1 + s^0.999"}) {
    EXPECT_GT(end_of(loop_of(controller, .6)).impacts.size(), 2U) << controller;
  }
  const auto pd = frac::FractionalTransferFunction::parse("1 + s");
  EXPECT_GT(end_of(ControlLoop({1e-6, 1, 1, .6}, pd)).impacts.size(), 2U);
  EXPECT_GT(end_of(ControlLoop({1, 1e-6, 1, .6}, pd)).impacts.size(), 2U);
  EXPECT_GT(end_of(loop_of("1 + s", 1)).impacts.size(), 20U);
  // An unstable controller drives harder and harder impacts.
  EXPECT_NE(end_of(loop_of("1/(s - 1)", .6), 200).end, LoopEnd::duration);
  support::expect_invalid_argument([] { (void)loop_of("s^2.1", .6); }, {"s^2.1"});
}

// Sizes near the ends of the range of numbers, and times that one body has thousands of while the other has none.
TEST(SimulateLoop, ExtremeScenesEnd) {
  LoopSimulationOptions options;
  options.duration = 10;
  options.most_impacts = 200;
  for (const char* controller : {"1e308", "1e-308", "1e300 s", "1 + s^0.5", "exp(-0.1 s) (2 + s)"}) {
    for (const double mass : {1e-308, 1e-12, 1.0, 1e20}) {
      const ControlLoop loop({1, mass, 1, .6}, frac::FractionalTransferFunction::parse(controller));
      EXPECT_LE(simulate_loop(loop, {0, 0, 0, 1}, {}, options).impacts.size(), 200U) << controller << ' ' << mass;
      EXPECT_LE(simulate_loop(loop, {}, {0, -1e308}, options).impacts.size(), 200U) << controller << ' ' << mass;
    }
  }
  // The heavy body needs 10^10 s, in which the light one bounces on without end.
  const ControlLoop heavy({1, 1e20, 1, .6}, frac::FractionalTransferFunction::parse("1 + s^0.5"));
  EXPECT_EQ(impact_cycles(heavy, {}).motions.size(), static_cast<std::size_t>(ImpactCycleOptions().starts));
}

TEST(SimulateLoop, RefusesWhatItDoesNotFollow) {
  const ControlLoop loop = loop_of("1 + s^0.5", .6);
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {0, 0, .6, 0}, {}); }, {"0.6", "0.5"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1 + s^1.2", .6), {}, {1, 0}); }, {"s^1.2"});
  LoopSimulationOptions whole;
  whole.whole_memory = true;
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1/(s + 1)", .6), {}, {}, whole); },
                                   {"sum of powers"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop_of("1 + s", 0), {}, {}, whole); }, {"restitution 0"});
  support::expect_invalid_argument(
      [&] {
        (void)simulate_loop(loop, {}, {0, 0, 1, 1, {}}, whole);
      },
      {"step and a ramp"});
  const frac::FractionalTransferFunction damped = frac::FractionalTransferFunction::parse("1/(s^2 + s)");
  const ControlLoop with_friction(LinearBodies(damped, free_mass(1), 1, .6), loop.controller());
  support::expect_invalid_argument([&] { (void)simulate_loop(with_friction, {}, {}, whole); }, {"free masses"});
  const ControlLoop delayed({1, 1, 1, .6}, frac::FractionalTransferFunction::parse("exp(-0.1 s) (1 + s)"), Output::x2);
  support::expect_invalid_argument([&] { (void)simulate_loop(delayed, {}, {}); }, {"dead time"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {0, 0, 0, 0, {{.1, 0}}}); }, {"0.1"});
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {0, 0, 1, 0, {}}); }, {"frequency"});
  LoopSimulationOptions rough;
  rough.tolerance = 1;
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {}, rough); }, {"tolerance 1"});
  LoopSimulationOptions options;
  options.duration = -1;
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {}, options); }, {"duration"});
}

}  // namespace
}  // namespace backlash
