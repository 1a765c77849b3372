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
#include "rest_cycles.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<LoopRegime, std::string_view>, 4> regime_names{{{LoopRegime::cycle, "cycle"},
                                                                               {LoopRegime::quiet, "quiet"},
                                                                               {LoopRegime::irregular, "irregular"},
                                                                               {LoopRegime::diverged, "diverged"}}};
// Newton's method finds the cycle itself.
constexpr double tolerance = 1e-4;
// Of cycles with rests, which have no sums over earlier periods.
constexpr double rest_tolerance = 1e-9;
// In units of the inverse pace: without an impact for so long there is none to come.
constexpr double patience = 200;

// In units of the pace: of distances that grow in proportion to time the mean rate over a quarter of the rounds of
// growth_beside(), the fewest that count, is ln(200)/200.
constexpr double regular_growth = 0.03;

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

// A motion until it repeats or has had its number of impacts.
struct Followed {
  std::vector<LoopImpact> impacts;
  std::vector<detail::LoopRun> releases;        // right after each, the last ones
  std::optional<detail::RestPattern> repeated;  // from release to release
  bool rests = false;                           // and has not ceased to
  bool is_quiet = false;
};
Followed follow(detail::LoopRun& run, const detail::RealisedLoop& realised, std::size_t most_impacts) {
  // Number of releases that are kept: twice as many as a pattern has and one.
  constexpr std::size_t most_kept = 25;
  Followed result;
  double last = 0;
  std::size_t landings = 0;
  // Bounces that become faster and faster count as one impact.
  while (landings < most_impacts && result.impacts.size() < 100 * most_impacts && !run.is_stuck() &&
         !run.has_diverged()) {
    const detail::LoopRun::Event event = run.advance(last + patience / realised.pace() + realised.delay());
    if (event == detail::LoopRun::Event::none) {
      result.is_quiet = !run.is_spent();
      break;
    }
    if (event == detail::LoopRun::Event::impact) {
      result.impacts.push_back(run.last_impact());
      landings += run.time() - last > 1e-2 / realised.pace();
      last = run.time();
    } else if (event == detail::LoopRun::Event::release) {
      if (result.releases.size() == most_kept) result.releases.erase(result.releases.begin());
      result.releases.push_back(run);
      result.repeated = detail::repeated_rests(realised, result.releases, 1e-3);
      if (result.repeated) break;
    }
  }
  result.rests = !result.releases.empty() && run.time() - result.releases.back().time() < patience / realised.pace();
  if (!result.repeated && !result.is_quiet && result.rests) {
    result.repeated = detail::repeated_rests(realised, result.releases, 0.02);
  }
  result.is_quiet = result.is_quiet || run.is_stuck();
  return result;
}

// A stable cycle with rests near a pattern.  Where the mean of the motion decays slowly, what becomes symmetric repeats
// itself long before it repeats its mirror image.
std::optional<ImpactCycle> rest_cycle(const ControlLoop& loop, const detail::RealisedLoop& realised,
                                      const detail::RestPattern& pattern, int harmonics) {
  std::optional<ImpactCycle> cycle;
  if (!pattern.is_mirror && pattern.releases % 2 == 0) {
    cycle = detail::close_rests(loop, realised, {pattern.release, pattern.releases / 2, true}, harmonics);
  }
  if (!cycle || !cycle->stability.stable) cycle = detail::close_rests(loop, realised, pattern, harmonics);
  if (cycle && !cycle->stability.stable) cycle.reset();
  return cycle;
}

// The same of a loop that is realised roughly.
std::optional<ImpactCycle> rest_cycle(const ControlLoop& loop, const detail::RealisedLoop& rough,
                                      const detail::RestPattern& pattern, const ImpactCycleOptions& options) {
  if (rough.error() == 0) return rest_cycle(loop, rough, pattern, options.harmonics);
  const detail::RealisedLoop realised(loop, {}, std::numeric_limits<double>::infinity(), rest_tolerance);
  const LoopRow row = pattern.release.row(LoopEvent::sample);
  detail::LoopRun run(realised, {row.x1, row.v1, row.x2, row.v2}, {});
  const Followed followed = follow(run, realised, options.impacts);
  if (!followed.repeated) return std::nullopt;
  return rest_cycle(loop, realised, *followed.repeated, options.harmonics);
}

// The pattern is that of the cycle, of its mirror image, or of half of it.
bool is_near(double length, const ImpactCycle& cycle) {
  const auto is_period = [&](double period) { return std::abs(period / cycle.period - 1) < 3e-3; };
  return !cycle.rests.empty() && (is_period(length) || is_period(2 * length));
}

// The motion has come near the cycle, or near its mirror image; what repeats may be several of its periods.
bool is_near(const CycleGuess& guess, const ImpactCycle& cycle) {
  if (!cycle.rests.empty() || guess.impacts.size() % cycle.impacts.size() != 0) return false;
  const auto periods = static_cast<double>(guess.impacts.size() / cycle.impacts.size());
  double hardest = 0;
  for (const CycleImpact& impact : guess.impacts) hardest = std::max(hardest, std::abs(impact.impulse));
  return std::abs(guess.period / (periods * cycle.period) - 1) < 3e-3 &&
         std::abs(hardest / cycle.impacts.front().impulse - 1) < 1e-2;
}

// The least period of a cycle, where it is a part of the one given: a motion that turns about its cycle by a third of
// a circle in each period seems to repeat after three.
std::optional<CycleGuess> least_period(const ImpactCycle& cycle) {
  constexpr double rounding = 1e-8;
  const std::vector<CycleImpact>& impacts = cycle.impacts;
  for (std::size_t n = 1; n < impacts.size(); ++n) {
    if (impacts.size() % n != 0) continue;
    const double period = cycle.period * static_cast<double>(n) / static_cast<double>(impacts.size());
    bool repeats = true;
    for (std::size_t a = 0; a + n < impacts.size() && repeats; ++a) {
      const CycleImpact& now = impacts[a];
      const CycleImpact& later = impacts[a + n];
      repeats = std::abs(later.time - now.time - period) <= rounding * cycle.period &&
                std::abs(later.impulse / now.impulse - 1) <= rounding;
    }
    if (repeats) return CycleGuess{period, {impacts.begin(), impacts.begin() + static_cast<std::ptrdiff_t>(n)}};
  }
  return std::nullopt;
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
    const Followed followed = follow(run, realised, options.impacts);
    // The cycle that is known already, or a new one that could be closed.
    const auto settle = [&](const auto& is_it, const auto& close) {
      const auto known = std::find_if(result.cycles.begin(), result.cycles.end(), is_it);
      const auto index = static_cast<std::size_t>(known - result.cycles.begin());
      if (known == result.cycles.end()) {
        std::optional<ImpactCycle> cycle = close();
        if (!cycle) return;
        result.cycles.push_back(*std::move(cycle));
      }
      motion.cycle = index;
      motion.regime = LoopRegime::cycle;
    };
    if (run.has_diverged()) {
      motion.regime = LoopRegime::diverged;
    } else if (followed.is_quiet) {
      motion.regime = LoopRegime::quiet;
    } else if (followed.repeated) {
      const auto of_pattern = static_cast<std::ptrdiff_t>(followed.repeated->releases);
      const double length = followed.releases.back().time() - (followed.releases.end() - 1 - of_pattern)->time();
      settle([&](const ImpactCycle& cycle) { return is_near(length, cycle); },
             [&] { return rest_cycle(loop, realised, *followed.repeated, options); });
    } else if (const auto guess = repeated_pattern(loop, followed.impacts)) {
      settle([&](const ImpactCycle& cycle) { return is_near(*guess, cycle); },
             [&] {
               auto cycle = close_cycle(loop, *guess, options.harmonics);
               const bool is_it = cycle && cycle->admissible && cycle->stability.stable &&
                                  std::abs(cycle->period / guess->period - 1) < 0.05;
               if (!is_it) cycle.reset();
               const auto shorter = cycle ? least_period(*cycle) : std::nullopt;
               return shorter ? close_cycle(loop, *shorter, options.harmonics) : cycle;
             });
    }
    if (motion.regime == LoopRegime::irregular && !realised.has_twin() && !followed.rests) {
      motion.lyapunov_exponent = growth_beside(run, realised);
      motion.chaotic = motion.lyapunov_exponent > regular_growth * realised.pace();
    }
    result.motions.push_back(motion);
  }
  // Cycles by rising frequency.
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
