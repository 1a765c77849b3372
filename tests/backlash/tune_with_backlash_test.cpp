// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/design/tune_with_backlash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "backlash/loops/simulate_loop.hpp"

namespace {

constexpr double pi = std::numbers::pi;

frac::LoopSpecification demands(double crossover, double margin_deg) {
  frac::LoopSpecification asked;
  asked.crossover = crossover;
  asked.phase_margin = margin_deg * pi / 180;
  return asked;
}

backlash::LinearBodies viscous(double mass1, double friction1, double mass2, double friction2, double clearance,
                               double restitution) {
  return {{{{1, 0}}, {{mass1, 2}, {friction1, 1}}}, {{{1, 0}}, {{mass2, 2}, {friction2, 1}}}, clearance, restitution};
}

/// A body M x'' + b x' = f that flies exactly under a constant force.
struct Flying {
  double mass, friction, x = 0, v = 0;
  void fly(double force, double time) {
    if (friction == 0) {
      x += time * (v + force / mass * time / 2);
      v += force / mass * time;
      return;
    }
    const double rate = friction / mass, last = force / friction, grown = -std::expm1(-rate * time);
    x += last * time + (v - last) * grown / rate;
    v += (last - v) * grown;
  }
};

/// Half of peak to peak of the measured body in the last tenth of a simulation: exact flights under a force that is
/// held over a step, impacts found by bisection within it, powers of s by their binomial sums over the whole past.  A
/// held force is half a step late and the sum of a power q late by another q/2 of one, so that each term reads the body
/// by as much ahead as its speed carries it: what is left is of second order in the step.
double simulated_swing(const backlash::BacklashPlant& plant, double friction1, double friction2,
                       const frac::FractionalPidGains& gains, double speed, double step, int steps) {
  struct Term {
    double gain, order;
    std::vector<double> weight{}, ahead{};
  };
  std::vector<Term> terms{{gains.kp, 0}, {gains.ki, -gains.lambda}, {gains.kd, gains.mu}};
  for (Term& term : terms) {
    term.weight = {std::pow(step, -term.order)};
    for (int i = 1; i < steps; ++i) term.weight.push_back(term.weight.back() * (1 - (term.order + 1) / i));
  }
  const backlash::TwoMassSystem& system = plant.bodies.system();
  Flying load{system.mass1(), friction1}, drive{system.mass2(), friction2, 0, speed};
  std::vector<double> measured;
  for (int i = 0; i < steps; ++i) {
    const Flying& body = plant.measured == backlash::Output::x1 ? load : drive;
    measured.push_back(body.x);
    double force = 0;
    for (Term& term : terms) {
      term.ahead.push_back(body.x + body.v * step * (1 + term.order) / 2);
      if (term.gain == 0) continue;
      double sum = 0;
      for (int k = 0; k <= i; ++k)
        sum += term.weight[static_cast<std::size_t>(k)] * term.ahead[static_cast<std::size_t>(i - k)];
      force -= term.gain * sum;
    }
    double left = step;
    for (int impacts = 0; left > 0; ++impacts) {
      const auto gap_after = [&](double time) {
        Flying a = load, b = drive;
        a.fly(0, time);
        b.fly(force, time);
        return b.x - a.x;
      };
      const double wall = system.clearance() / 2;
      double time = left;
      const bool hits = std::abs(gap_after(left)) > wall;
      if (hits) {
        double inside = 0;
        for (int halving = 0; halving < 40; ++halving) {
          const double middle = (inside + time) / 2;
          (std::abs(gap_after(middle)) > wall ? time : inside) = middle;
        }
      }
      load.fly(0, time);
      drive.fly(force, time);
      left -= time;
      if (!hits) break;
      const double closing = drive.v - load.v;
      const bool towards = (drive.x > load.x) == (closing > 0);
      // After so many impacts in one step the bodies go on together.
      const double restitution = impacts < 20 ? system.restitution() : 0;
      const double impulse = towards ? (1 + restitution) * closing / (1 / load.mass + 1 / drive.mass) : 0;
      load.v += impulse / load.mass;
      drive.v -= impulse / drive.mass;
      if (impacts >= 20) {
        load.fly(0, left);
        drive.fly(0, left);
        drive.x = std::clamp(drive.x, load.x - wall, load.x + wall);
        left = 0;
      }
    }
  }
  const auto [low, high] = std::minmax_element(measured.end() - steps / 10, measured.end());
  return (*high - *low) / 2;
}

// For kp + kd s of free masses all is known: the demands fix kp = M wc^2 cos(margin) and kd = M wc sin(margin), the
// cycle has omega = (pi/2) kd (1 + eps)/(M (1 - eps)), and the load moves on a triangular wave.
TEST(TuneWithBacklash, MeetsTheClosedFormOfThePdLaw) {
  const double mass1 = 1.2, mass2 = 0.7, clearance = 0.02, restitution = 0.4, crossover = 3;
  frac::TuningOptions options;
  options.structure = frac::ControllerStructure::pd;
  options.mu = {1, 1};
  const auto asked = demands(crossover, 50);
  const auto result =
      backlash::tune_with_backlash({backlash::TwoMassSystem(mass1, mass2, clearance, restitution)}, asked, options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double mass = mass1 + mass2, kp = mass * crossover * crossover * std::cos(*asked.phase_margin),
               kd = mass * crossover * std::sin(*asked.phase_margin);
  EXPECT_NEAR(result.linear.gains.kp, kp, 1e-9 * kp);
  EXPECT_NEAR(result.linear.gains.kd, kd, 1e-9 * kd);
  const double omega = pi / 2 * kd * (1 + restitution) / (mass * (1 - restitution));
  ASSERT_EQ(result.persistent.cycles.size(), 1U);
  EXPECT_NEAR(result.persistent.cycles[0].omega, omega, 1e-9 * omega);
  const double sum = -(1 / mass1 + 1 / mass2) * pi * pi / (8 * omega * omega) +
                     kp * std::pow(omega, -4) * std::pow(pi, 4) / 96 / (mass1 * mass2);
  const double impulse = -(clearance / 2) * pi / (2 * omega * sum);
  // From peak to peak half a period at the speed impulse/(2 M1).  The 200 harmonics that the swing is summed from leave
  // a triangle short of its corner by 1/(400 pi^2/8) of it.
  const double swing = impulse / (2 * mass1) * pi / omega / 2;
  EXPECT_NEAR(result.persistent.swing, swing, 3e-3 * swing);
  EXPECT_TRUE(result.persistent.verified) << result.message;
  EXPECT_NE(result.message.find("mu held"), std::string::npos) << result.message;
}

// What is said to persist is what two other simulations show: of free masses the exact one with the whole memory, of
// bodies with friction one with exact flights and direct sums.  A swing that is told by steps of the library's own
// simulation may be off by their share of a period, 1 % to 2 %, and so may the other's; a motion that has not quite
// come to rest on its cycle adds as much: 6 % together.
TEST(TuneWithBacklash, WhatPersistsIsWhatOtherSimulationsShow) {
  int without = 0, smaller = 0;
  constexpr unsigned plants = 6;
  for (unsigned seed = 0; seed < plants; ++seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> uniform;
    const double mass1 = 0.5 + 2 * uniform(generator), mass2 = 0.5 + 2 * uniform(generator);
    const double restitution = 0.1 + 0.7 * uniform(generator), clearance = 0.01 + uniform(generator);
    const bool is_free = seed % 3 == 0;
    const double friction1 = is_free ? 0 : 2 * uniform(generator), friction2 = is_free ? 0 : 2 * uniform(generator);
    const double crossover = std::pow(10, -0.5 + uniform(generator)), margin = 30 + 30 * uniform(generator);
    const backlash::BacklashPlant plant{
        is_free ? backlash::LinearBodies(backlash::TwoMassSystem(mass1, mass2, clearance, restitution))
                : viscous(mass1, friction1, mass2, friction2, clearance, restitution),
        seed % 3 == 2 ? backlash::Output::x2 : backlash::Output::x1};
    // Beyond this order the steps of these simulations are not short enough.
    frac::TuningOptions orders;
    orders.mu.upper = 1.2;
    const auto result = backlash::tune_with_backlash(plant, demands(crossover, margin), orders);
    ASSERT_TRUE(result.usable()) << seed << ": " << result.message;
    EXPECT_NEAR(result.linear.crossover, crossover, 1e-6 * crossover);
    EXPECT_NEAR(result.linear.phase_margin * 180 / pi, margin, 1e-4);
    const double swing = result.persistent.swing;
    EXPECT_LE(swing, result.of_regardless.swing);
    without += swing == 0;
    smaller += swing < 0.98 * result.of_regardless.swing;
    const auto& gains = result.linear.gains;
    double shown = 0;
    for (const double speed : {0.3, 3.0}) {
      const double start = speed * crossover * clearance;
      if (is_free) {
        backlash::LoopSimulationOptions options;
        options.duration = 40 * 2 * pi / crossover;
        options.most_impacts = 600;
        const auto history =
            backlash::simulate_loop(backlash::ControlLoop(plant.bodies, frac::controller_transfer_function(gains)),
                                    {0, 0, 0, start}, {}, options);
        if (history.end == backlash::LoopEnd::rest) continue;
        double low = INFINITY, high = -INFINITY;
        for (const auto& row : history.rows) {
          if (row.time < 0.9 * history.end_time) continue;
          low = std::min(low, row.x1);
          high = std::max(high, row.x1);
        }
        // The load flies straight from impact to impact, so that rows at impacts have its peaks.
        shown = std::max(shown, (high - low) / 2);
      } else {
        const double period =
            2 * pi / (result.persistent.cycles.empty() ? crossover : result.persistent.cycles.back().omega);
        const double step = std::min(period / 300, 2 * pi / crossover / 300);
        const int steps = static_cast<int>(std::min(12000.0, 30 * 2 * pi / crossover / step));
        shown = std::max(shown, simulated_swing(plant, friction1, friction2, gains, start, step, steps));
      }
    }
    if (swing == 0) {
      EXPECT_LT(shown, 0.03 * clearance) << seed << ": " << result.message;
    } else {
      EXPECT_NEAR(shown, swing, 0.06 * swing) << seed << ": " << result.message;
    }
  }
  EXPECT_GE(without, 1);
  EXPECT_GE(smaller, 2);
}

// A clearance that matters is named as the constraint that it is, and one that does not is not.
TEST(TuneWithBacklash, SaysWhichConstraintsAreActive) {
  const auto constraint = [](const backlash::BacklashTuning& result, const std::string& name) {
    const auto found = std::find_if(result.constraints.begin(), result.constraints.end(),
                                    [&](const backlash::TuningConstraint& each) { return each.name == name; });
    EXPECT_NE(found, result.constraints.end()) << name;
    return found == result.constraints.end() ? backlash::TuningConstraint{} : *found;
  };
  auto asked = demands(2, 45);
  asked.max_sensitivity = 50;
  const auto held = backlash::tune_with_backlash({backlash::TwoMassSystem(1, 1, 0.01, 0.6)}, asked);
  ASSERT_TRUE(held.usable()) << held.message;
  EXPECT_TRUE(constraint(held, "no limit cycle").active);
  EXPECT_TRUE(constraint(held, "phase margin, deg").active);
  EXPECT_FALSE(constraint(held, "max |S|").active);
  EXPECT_GT(held.persistent.swing, 0);
  // Measured on the driven body, heavy friction on the load: nothing persists anyway.
  const auto free = backlash::tune_with_backlash({viscous(1, 3, 1, 1, 0.01, 0.3), backlash::Output::x2}, asked);
  ASSERT_TRUE(free.usable()) << free.message;
  EXPECT_EQ(free.persistent.swing, 0) << free.message;
  EXPECT_FALSE(constraint(free, "no limit cycle").active);
}

TEST(TuneWithBacklash, NeedsACrossover) {
  frac::LoopSpecification asked;
  asked.max_sensitivity = 2;
  EXPECT_THROW(static_cast<void>(backlash::tune_with_backlash({backlash::TwoMassSystem(1, 1, 1, 0.5)}, asked)),
               std::invalid_argument);
}

}  // namespace
