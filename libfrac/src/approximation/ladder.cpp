// SPDX-License-Identifier: BSD-3-Clause
#include "ladder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "frac/cancellation.hpp"
#include "log_pole_problem.hpp"

namespace frac::detail {
namespace {

struct Optimum {
  LogPoles log_poles;
  double error;
  bool is_hopeless;  // left unfinished
};

Optimum optimal_log_poles(const UnitProblem& problem, LogPoles current, double hopeless_above) {
  constexpr int most_steps = 60;
  constexpr int most_sharpenings = 18;
  constexpr double close_enough = 1.015;  // largest error by the bound on it
  // Below it the error is the rounding of the extended evaluation.
  constexpr double noise = 64 * static_cast<double>(std::numeric_limits<long double>::epsilon());

  LogPoleProblem least(problem, static_cast<int>(current.size()));
  least.evaluate(current);
  LogPoles best = current;
  double best_error = least.largest();
  double bound = 0;
  int sharpenings = 0;
  // Relative to the error, and its bounds: below the lower a displacement is not held at all in double, the upper
  // leaves a minimax step unchanged to six digits.
  double damping = 1e-5;
  constexpr double least_damping = 1e-9;
  constexpr double most_damping = 1e-3;
  for (int i = 0; i < most_steps && best_error > noise; ++i) {
    throw_if_cancelled();
    const LogPoleProblem::Step step = least.weighted_step(current, damping);
    if (step.change.empty()) break;
    const bool settled = least.largest() < 4 * step.predicted;
    if (settled) {
      bound = std::max(bound, step.predicted);
      if (best_error <= close_enough * bound || bound > hopeless_above || sharpenings == most_sharpenings) break;
    }
    const double mean = least.weighted_mean();
    double share = 1;
    bool improved = false;
    for (; share > 1e-3; share /= 2) {
      LogPoles trial = moved(current, step.change, share);
      if (!interlaced(trial)) continue;
      least.evaluate(trial);
      if (least.weighted_mean() < mean * (1 + 1e-3)) {
        current = std::move(trial);
        improved = true;
        break;
      }
    }
    if (!improved && damping == most_damping) break;
    damping = !improved || least.weighted_mean() > 0.5 * mean ? std::min(10 * damping, most_damping)
                                                              : std::max(damping / 10, least_damping);
    if (!improved) {
      least.evaluate(current);
      continue;
    }
    if (least.largest() < best_error) {
      best_error = least.largest();
      best = current;
    }
    // Weights are worth sharpening once the step no longer changes the error by orders of magnitude.
    if (least.largest() < 4 * step.predicted) {
      least.sharpen(sharpenings < 3 ? 2 : 1);
      ++sharpenings;
    }
  }
  return {std::move(best), best_error, bound > hopeless_above};
}

// As 1 - order becomes smaller, each pole nears the zero above it in proportion, and the last one, which has none,
// moves away as 1/(1 - order).
LogPoles continued(const LogPoles& log_poles, double ratio) {
  LogPoles result = log_poles;
  const std::size_t last = log_poles.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    const long double gap = -log_poles[last - 1 - i] - log_poles[i];
    result[i] += (1 - static_cast<long double>(ratio)) * gap / 2;
  }
  result[last] -= std::log(static_cast<long double>(ratio));
  return result;
}

// From order 1/2, where the start is good for any number of poles, to an order next to 1.
Optimum continued_optimum(const UnitProblem& problem, int poles, double hopeless_above) {
  constexpr double shrink = 0.25;
  UnitProblem at{0.5, problem.half_width};
  Optimum optimum = optimal_log_poles(at, starting_log_poles(at, poles), 1);
  while (at.order < problem.order) {
    const double rest = std::max(shrink * (1 - at.order), 1 - problem.order);
    const double ratio = rest / (1 - at.order);
    at.order = rest > 1 - problem.order ? 1 - rest : problem.order;
    optimum = optimal_log_poles(at, continued(optimum.log_poles, ratio), at.order < problem.order ? 1 : hopeless_above);
  }
  return optimum;
}

// What the limit of theory leaves, generously, and the rounding of doubles.
double expected_error(const UnitProblem& problem, int poles) {
  const double width = 2 * problem.half_width + 4 * std::numbers::ln2;
  return 10 * 2 * std::sin(std::numbers::pi * problem.order) *
             std::exp(-std::numbers::pi * std::numbers::pi * poles / width) +
         1e-15;
}

}  // namespace

UnitDesign ladder_design(const UnitProblem& problem, int poles, double hopeless_above) {
  Optimum optimum = optimal_log_poles(problem, starting_log_poles(problem, poles), hopeless_above);
  // With more poles than a narrow band needs, the start for an order near 1 may lie where no step leads on.
  if (!optimum.is_hopeless && problem.order > 0.5 && optimum.error > expected_error(problem, poles)) {
    Optimum other = continued_optimum(problem, poles, hopeless_above);
    if (other.error < optimum.error) optimum = std::move(other);
  }
  UnitDesign design;
  for (const long double x : optimum.log_poles) {
    design.poles.push_back(std::exp(x));
    design.zeros.push_back(std::exp(-x));
    design.gain *= design.poles.back();
  }
  std::reverse(design.zeros.begin(), design.zeros.end());
  return design;
}

}  // namespace frac::detail
