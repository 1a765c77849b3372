// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/impact_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/check.hpp"
#include "base/impact_law.hpp"
#include "loops/equations/cycle_equations.hpp"
#include "loops/equations/cycle_harmonics.hpp"
#include "loops/equations/cycle_stability.hpp"
#include "loops/equations/gap_response.hpp"

namespace backlash {
namespace {

// Begins with the hardest impact.  A mirror image has it at the far wall.
struct Order {
  std::size_t first;
  double sign;
};
Order order_of(const detail::ClosedMotion& motion) {
  std::size_t first = 0;
  for (std::size_t a = 1; a < motion.shares.size(); ++a) {
    const double more = std::abs(motion.impulses[a]) / std::abs(motion.impulses[first]) - 1;
    const bool is_equal = std::abs(more) <= 1e-9;  // but for rounding: the one at the far wall
    if (is_equal ? motion.impulses[first] < 0 && motion.impulses[a] > 0 : more > 0) first = a;
  }
  return {first, motion.impulses[first] > 0 ? 1.0 : -1.0};
}

bool is_symmetric(const detail::ClosedMotion& motion, double half_clearance) {
  const std::size_t n = motion.shares.size();
  constexpr double tolerance = 1e-8;
  if (n % 2 == 1 || std::abs(motion.middle) > tolerance * half_clearance) return false;
  for (std::size_t a = 0; a < n / 2; ++a) {
    if (std::abs(motion.shares[a + n / 2] - motion.shares[a] - 0.5) > tolerance) return false;
    if (std::abs(motion.impulses[a + n / 2] / motion.impulses[a] + 1) > tolerance) return false;
  }
  return true;
}

void require_valid(const CycleGuess& guess) {
  detail::require_positive("period", "s", guess.period);
  if (guess.impacts.empty()) throw std::invalid_argument("the guess of a cycle has no impacts");
  if (guess.impacts.front().time != 0) throw std::invalid_argument("the first impact of the guess is not at time 0");
  for (std::size_t a = 0; a < guess.impacts.size(); ++a) {
    const CycleImpact& impact = guess.impacts[a];
    const double until = a + 1 < guess.impacts.size() ? guess.impacts[a + 1].time : guess.period;
    if (!(impact.time < until)) {
      throw std::invalid_argument("impact " + std::to_string(a + 1) + " of the guess is at " +
                                  detail::text(impact.time) + " s; times rise and stay below the period");
    }
    if (impact.impulse == 0 || !std::isfinite(impact.impulse)) {
      throw std::invalid_argument("impulse " + std::to_string(a + 1) + " of the guess is " +
                                  detail::text(impact.impulse) + " N s; it is finite and not 0");
    }
  }
}

}  // namespace

std::optional<ImpactCycle> close_cycle(const ControlLoop& loop, const CycleGuess& guess, int harmonics) {
  require_valid(guess);
  if (harmonics < 1) throw std::invalid_argument("harmonics is less than 1");
  return detail::closed_cycle(loop, guess, harmonics, true);
}

std::optional<ImpactCycle> detail::closed_cycle(const ControlLoop& loop, const CycleGuess& guess, int harmonics,
                                                bool judges) {
  const detail::CycleEquations equations(loop, guess);
  const std::optional<detail::CycleEquations::Solution> solution = equations.solve(guess);
  if (!solution) return std::nullopt;
  const detail::ClosedMotion& found = solution->motion;

  const std::size_t count = found.shares.size();
  const Order order = order_of(found);
  detail::ClosedMotion motion{found.period, {}, {}, order.sign * found.middle};
  std::vector<double> times;
  ImpactCycle cycle{};
  for (std::size_t a = 0; a < count; ++a) {
    const std::size_t from = (order.first + a) % count;
    const double share = found.shares[from] - found.shares[order.first];
    motion.shares.push_back(share < 0 ? share + 1 : share);
    motion.impulses.push_back(order.sign * found.impulses[from]);
    times.push_back(motion.period * motion.shares[a]);
    cycle.impacts.push_back({times[a], motion.impulses[a], equations.exchange() * std::abs(motion.impulses[a])});
  }
  cycle.period = motion.period;
  cycle.middle = motion.middle;
  cycle.symmetric = is_symmetric(motion, equations.half_clearance());
  cycle.reason = equations.reason_against(found);
  cycle.admissible = cycle.reason.empty();
  if (judges) {
    std::vector<double> bend = equations.gap(motion, 2);
    for (std::size_t a = 0; a < count; ++a) bend[a] /= -motion.impulses[a];
    const detail::ImpulseTrain train(equations.response(), motion.period);
    cycle.stability = detail::cycle_stability(equations.response(), train, times, bend, equations.exchange());
  }
  cycle.error = solution->error;
  const double omega = 2 * std::numbers::pi / motion.period;
  for (int k = 1; k <= harmonics; ++k) {
    cycle.harmonics.push_back(detail::cycle_harmonic(loop, omega, k, detail::CycleEquations::strength(motion, k)));
  }
  return cycle;
}

std::optional<CycleGuess> repeated_pattern(const ControlLoop& loop, const std::vector<LoopImpact>& impacts,
                                           std::size_t most, double tolerance) {
  const TwoMassSystem& system = loop.system();
  for (std::size_t n = 1; n <= most && 2 * n + 1 <= impacts.size(); ++n) {
    const std::size_t last = impacts.size() - 1;
    const double period = impacts[last].time - impacts[last - n].time;
    double fastest = 0;
    for (std::size_t a = 0; a < n; ++a) fastest = std::max(fastest, impacts[last - a].speed);
    bool repeats = period > 0;
    for (std::size_t a = 0; a < n && repeats; ++a) {
      const LoopImpact& now = impacts[last - a];
      const LoopImpact& then = impacts[last - a - n];
      repeats = now.wall == then.wall && std::abs(now.speed - then.speed) <= tolerance * fastest &&
                std::abs(now.time - then.time - period) <= tolerance * period;
    }
    if (!repeats) continue;
    CycleGuess guess{period, {}};
    for (std::size_t a = 0; a < n; ++a) {
      const LoopImpact& impact = impacts[last - n + a];
      const double sign = impact.wall == Wall::far ? 1 : -1;
      guess.impacts.push_back({impact.time - impacts[last - n].time,
                               sign * detail::impulse_per_speed(system) * impact.speed, impact.speed});
    }
    return guess;
  }
  return std::nullopt;
}

std::vector<const ImpactCycle*> further_cycles(const std::vector<ImpactCycle>& found,
                                               const std::vector<SymmetricCycle>& listed) {
  std::vector<const ImpactCycle*> further;
  for (const ImpactCycle& cycle : found) {
    const double omega = 2 * std::numbers::pi / cycle.period;
    const bool is_listed = std::any_of(listed.begin(), listed.end(), [&](const SymmetricCycle& known) {
      return std::abs(known.omega / omega - 1) < 1e-6;
    });
    if (!is_listed || !cycle.symmetric || cycle.impacts.size() != 2 || !cycle.rests.empty()) further.push_back(&cycle);
  }
  return further;
}

}  // namespace backlash
