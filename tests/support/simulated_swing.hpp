// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "backlash/design/tune_with_backlash.hpp"
#include "backlash/loops/simulate_loop.hpp"

/// Plants with backlash drawn from a seed, and what remains of the motion of a tuned loop by simulations that share
/// nothing with those of the tuning.
namespace support {

inline constexpr double pi = std::numbers::pi;

inline frac::LoopSpecification demands(double crossover, double margin_deg) {
  frac::LoopSpecification asked;
  asked.crossover = crossover;
  asked.phase_margin = margin_deg * pi / 180;
  return asked;
}

inline backlash::LinearBodies viscous(double mass1, double friction1, double mass2, double friction2, double clearance,
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
inline double simulated_swing(const backlash::BacklashPlant& plant, double friction1, double friction2,
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

struct TunedPlant {
  backlash::BacklashPlant plant;
  double friction1, friction2;
  frac::LoopSpecification asked;
  frac::TuningOptions options;
};

/// Free masses for every third seed, the driven body measured for every third.
inline TunedPlant drawn_plant(unsigned seed) {
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
  TunedPlant drawn{plant, friction1, friction2, demands(crossover, margin), {}};
  // Beyond this order the steps of these simulations are not short enough.
  drawn.options.mu.upper = 1.2;
  return drawn;
}

/// The larger swing of two starts, m: of free masses by the exact simulation with the whole memory, of bodies with
/// friction by exact flights and direct sums.
inline double shown_swing(const TunedPlant& drawn, const backlash::BacklashTuning& result) {
  const auto& gains = result.linear.gains;
  const double crossover = *drawn.asked.crossover;
  double shown = 0;
  for (const double speed : {0.3, 3.0}) {
    const double start = speed * crossover * drawn.plant.bodies.system().clearance();
    if (drawn.plant.bodies.are_free()) {
      backlash::LoopSimulationOptions options;
      options.duration = 40 * 2 * pi / crossover;
      options.most_impacts = 600;
      options.whole_memory = drawn.plant.measured == backlash::Output::x1;
      const auto history =
          backlash::simulate_loop(backlash::ControlLoop(drawn.plant.bodies, frac::controller_transfer_function(gains)),
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
      shown =
          std::max(shown, simulated_swing(drawn.plant, drawn.friction1, drawn.friction2, gains, start, step, steps));
    }
  }
  return shown;
}

}  // namespace support
