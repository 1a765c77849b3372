#include "ladder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "log_pole_problem.hpp"

namespace frac::detail {
namespace {

LogPoles optimal_log_poles(const UnitProblem& problem, int poles, double hopeless_above) {
  constexpr int most_steps = 60;
  constexpr int most_sharpenings = 18;
  constexpr double close_enough = 1.015;  // largest error by the bound on it
  // Below it the error is the rounding of the extended evaluation.
  constexpr double noise = 64 * static_cast<double>(std::numeric_limits<long double>::epsilon());

  LogPoleProblem least(problem, poles);
  LogPoles current = starting_log_poles(problem, poles);
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
  return best;
}

}  // namespace

UnitDesign ladder_design(const UnitProblem& problem, int poles, double hopeless_above) {
  UnitDesign design;
  for (const long double x : optimal_log_poles(problem, poles, hopeless_above)) {
    design.poles.push_back(std::exp(x));
    design.zeros.push_back(std::exp(-x));
    design.gain *= design.poles.back();
  }
  std::reverse(design.zeros.begin(), design.zeros.end());
  return design;
}

}  // namespace frac::detail
