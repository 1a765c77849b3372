// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

#include "contact_margin.hpp"
#include "orbit_correction.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double tolerance = 1e-10;

// Speeds of impacts are of the order of the clearance times omega, larger under strong forces.
constexpr double most_speed = 1.5;
// Force periods that motions are followed for the orbits they pass: several one after the other, where they settle.
constexpr std::int64_t followed_periods = 400;
// A state that comes back within this distance has settled, or Newton's iteration needs nothing nearer.
constexpr double settled_return = 1e-6;
// A state that comes back within this distance is where Newton's iteration begins.
constexpr double near_return = 0.1;

// Motions of one call begin so far apart in the sequence of starts: no two calls share one.
constexpr std::size_t between_starts = 1 << 16;

SegmentImpact impact_at(const GapState& state, double speed) {
  return {static_cast<double>(state.half_period) * pi - pi / 2 + state.s, speed, state.wall};
}

// The nearest returns of motions to where they were, and to the mirror image of that, by half periods and impacts.
class NearReturns {
 public:
  explicit NearReturns(const OrbitLimits& limits) : limits_(limits) {}

  struct Near {
    double distance;
    std::vector<SegmentImpact> impacts;
  };

  /// The motion that follows is another one.
  void begin() { met_.clear(); }
  /// Distance of the nearest return there.
  double add(const SegmentImpact& to) {
    met_.push_back(to);
    double least = near_return;
    for (int impacts = 1; impacts <= limits_.impacts && static_cast<std::size_t>(impacts) < met_.size(); ++impacts) {
      const auto from = met_.end() - 1 - impacts;
      const auto half_periods = static_cast<int>(std::lround((to.phase - from->phase) / pi));
      if (half_periods > 2 * limits_.period) break;
      const bool mirrored = half_periods % 2 != 0;
      if (half_periods < 1 || (from->wall != to.wall) != mirrored) continue;
      // The mirror half of an orbit counts twice.
      if (mirrored && (half_periods > limits_.period || 2 * impacts > limits_.impacts)) continue;
      const double distance =
          std::abs(to.phase - from->phase - half_periods * pi) + std::abs(to.speed - from->speed) / (1 + to.speed);
      least = std::min(least, distance);
      if (distance >= near_return) continue;
      Near& known = nearest_.try_emplace({half_periods, impacts}, Near{near_return, {}}).first->second;
      if (distance < known.distance) known = {distance, {from + 1, met_.end()}};
    }
    return least;
  }
  [[nodiscard]] const std::map<std::pair<int, int>, Near>& nearest() const noexcept { return nearest_; }

 private:
  OrbitLimits limits_;
  std::map<std::pair<int, int>, Near> nearest_;
  std::vector<SegmentImpact> met_;
};

}  // namespace

SearchStart search_start(std::size_t index) {
  // Roberts (2018): steps 1/g, 1/g^2, 1/g^3 with g^4 = g + 1.
  const auto place = [&](double step) { return std::fmod(0.5 + step * static_cast<double>(index), 1.0); };
  const SearchStart spread{place(0.8191725133961645), place(0.6710436067037893), 2 * place(0.5497004779019703) - 1};
  // Every eighth one is of those that sweeps and maps begin with.
  if (index % 16 == 0) return {spread.share, 0.5, 0};
  if (index % 16 == 8) return {spread.share, 0, 0};
  return spread;
}

GapState state_of(const SearchStart& start, const GapMotion& motion) {
  const double speed = most_speed * std::max(1.0, std::cbrt(motion.gamma()));
  return motion.peak_state(0, {start.position, speed * start.velocity});
}

std::optional<OrbitSegment> settled_orbit(const OrbitSegment& at, const GapState& start, Transients transients) {
  const GapMotion motion(at.gamma(), at.restitution);
  // Only closed orbits count here.
  const SteadyState steady = find_steady_state(motion, start, tolerance, {0, 0, transients, true});
  if (steady.regime != Regime::periodic && steady.regime != Regime::symmetric) return std::nullopt;
  const auto impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
  std::optional<OrbitSegment> found = orbit_through(motion, steady.end, impacts, 2 * steady.period);
  if (found) found->along = at.along;
  return found;
}

std::vector<OrbitSegment> orbits_passed(const OrbitSegment& at, std::size_t index, const OrbitLimits& limits) {
  const GapMotion motion(at.gamma(), at.restitution);
  NearReturns returns(limits);
  std::int64_t left = 2 * followed_periods;
  for (; left > 0; index += between_starts) {
    const GapState start = state_of(search_start(index), motion);
    const std::int64_t end = start.half_period + left;
    GapState state = start;
    returns.begin();
    while (state.half_period < end) {
      if (motion.rests(state) || motion.chatter_tail(state).negligible(tail_limit(motion, tolerance))) break;
      const Flight flight = motion.next_flight(state);
      if (!flight.hits) break;
      state = motion.after_impact(state, flight);
      if (returns.add(impact_at(state, flight.speed)) < settled_return) break;
    }
    left -= std::max<std::int64_t>(state.half_period - start.half_period, 2);
  }
  std::vector<OrbitSegment> found;
  for (const auto& [pattern, near] : returns.nearest()) {
    OrbitSegment guess = at;
    guess.half_periods = pattern.first;
    guess.impacts = near.impacts;
    std::optional<OrbitSegment> orbit = corrected_to_shortest(guess);
    if (orbit && contact_margin(*orbit).margin > 0) found.push_back(std::move(*orbit));
  }
  return found;
}

}  // namespace backlash::detail
