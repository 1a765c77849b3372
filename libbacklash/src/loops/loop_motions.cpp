// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

#include "backlash/loops/impact_cycles.hpp"
#include "base/spelling.hpp"
#include "loop_run.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<LoopRegime, std::string_view>, 4> regime_names{{{LoopRegime::cycle, "cycle"},
                                                                               {LoopRegime::quiet, "quiet"},
                                                                               {LoopRegime::irregular, "irregular"},
                                                                               {LoopRegime::diverged, "diverged"}}};
// Newton's method finds the cycle itself.
constexpr double tolerance = 1e-4;
// In units of the inverse pace: without an impact for so long there is none to come.
constexpr double patience = 200;

// Mean rate of growth of the distance of a motion from one beside it, which is brought back each time it has grown.
double growth_beside(detail::LoopRun run, const detail::RealisedLoop& loop) {
  constexpr double distance = 1e-7;
  constexpr int rounds = 400;
  // A light body may bounce any number of times while a heavy one moves.
  constexpr std::int64_t most_impacts = 50'000;
  detail::LoopRun beside = run;
  beside.displace(run, distance);
  const double begin = run.time();
  double logarithm = 0;
  int counted = 0;
  std::int64_t ahead = 0;
  std::int64_t followed = 0;
  const auto follow = [&](detail::LoopRun& motion, double until) {
    int impacts = 0;
    while (motion.time() < until && !motion.has_diverged() && !motion.is_stuck() && !motion.is_spent() &&
           followed < most_impacts) {
      const int impact = motion.advance(until) == detail::LoopRun::Event::impact ? 1 : 0;
      impacts += impact;
      followed += impact;
    }
    return impacts;
  };
  for (int i = 1; i <= rounds; ++i) {
    const double until = begin + i * 2 / loop.pace();
    ahead += follow(run, until) - follow(beside, until);
    if (followed == most_impacts || run.is_spent()) return std::numeric_limits<double>::quiet_NaN();
    const double apart = beside.distance(run);
    if (!std::isfinite(apart) || apart == 0) return std::numeric_limits<double>::quiet_NaN();
    // Between the impact of the one and that of the other they are apart by the jump.
    if (ahead != 0 || apart > 1e-3) {
      if (apart < 0.1) continue;
      // Too far to be neighbours: a new one, of which the growth so far is lost.
      beside = run;
      beside.displace(run, distance);
      ahead = 0;
      continue;
    }
    logarithm += std::log(apart / distance);
    ++counted;
    const detail::LoopRun last = beside;
    beside = run;
    beside.displace_towards(last, distance / apart);
  }
  return counted > rounds / 4 ? logarithm / (counted * 2 / loop.pace()) : std::numeric_limits<double>::quiet_NaN();
}

// The motion has come near the cycle, or near its mirror image.
bool is_near(const CycleGuess& guess, const ImpactCycle& cycle) {
  double hardest = 0;
  for (const CycleImpact& impact : guess.impacts) hardest = std::max(hardest, std::abs(impact.impulse));
  return guess.impacts.size() == cycle.impacts.size() && std::abs(guess.period / cycle.period - 1) < 3e-3 &&
         std::abs(hardest / cycle.impacts.front().impulse - 1) < 1e-2;
}

}  // namespace

std::string_view to_string(LoopRegime regime) {
  return frac::detail::spelling(regime_names, regime);
}

ImpactCycles impact_cycles(const ControlLoop& loop, const ImpactCycleOptions& options) {
  if (options.starts < 0) throw std::invalid_argument("starts is less than 0");
  if (options.impacts < 1) throw std::invalid_argument("impacts is 0");
  ImpactCycles result;
  const detail::RealisedLoop realised(loop, {}, std::numeric_limits<double>::infinity(), tolerance);
  std::mt19937_64 engine(options.seed);
  const auto unit = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const double speed = realised.pace() * loop.system().clearance();
  for (int k = 0; k < options.starts; ++k) {
    LoopStart start;
    start.v1 = speed * (0.4 * unit() - 0.2);
    start.v2 = speed * 0.2 * std::pow(25, unit());
    LoopMotion motion{start, LoopRegime::irregular, {}, std::numeric_limits<double>::quiet_NaN()};
    detail::LoopRun run(realised, start, {});
    std::vector<LoopImpact> impacts;
    double last = 0;
    while (impacts.size() < options.impacts && !run.is_stuck() && !run.has_diverged()) {
      const detail::LoopRun::Event event = run.advance(last + patience / realised.pace() + loop.controller().delay());
      if (event == detail::LoopRun::Event::none) break;
      if (event != detail::LoopRun::Event::impact) continue;
      impacts.push_back(run.last_impact());
      last = run.time();
    }
    if (run.has_diverged()) {
      motion.regime = LoopRegime::diverged;
    } else if (impacts.size() < options.impacts) {
      motion.regime = LoopRegime::quiet;
    } else if (const auto guess = repeated_pattern(loop, impacts)) {
      const auto known = std::find_if(result.cycles.begin(), result.cycles.end(),
                                      [&](const ImpactCycle& cycle) { return is_near(*guess, cycle); });
      motion.cycle = static_cast<std::size_t>(known - result.cycles.begin());
      if (known == result.cycles.end()) {
        const auto cycle = close_cycle(loop, *guess, options.harmonics);
        if (cycle && cycle->admissible && cycle->stability.stable &&
            std::abs(cycle->period / guess->period - 1) < 0.05) {
          result.cycles.push_back(*cycle);
        } else {
          motion.cycle.reset();
        }
      }
      if (motion.cycle) motion.regime = LoopRegime::cycle;
    }
    if (motion.regime == LoopRegime::irregular && !realised.has_twin()) {
      motion.lyapunov_exponent = growth_beside(run, realised);
    }
    result.motions.push_back(motion);
  }
  // By rising frequency.
  std::vector<std::size_t> order(result.cycles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.cycles[a].period > result.cycles[b].period; });
  std::vector<ImpactCycle> sorted;
  for (const std::size_t i : order) sorted.push_back(result.cycles[i]);
  for (LoopMotion& motion : result.motions) {
    if (motion.cycle) {
      motion.cycle = static_cast<std::size_t>(std::find(order.begin(), order.end(), *motion.cycle) - order.begin());
    }
  }
  result.cycles = std::move(sorted);
  return result;
}

}  // namespace backlash
