// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_search.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <utility>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double tolerance = 1e-10;

// Speeds of impacts are of the order of the clearance times omega, larger under strong forces.
constexpr double most_speed = 1.5;
// Force periods that a motion is followed for the orbits it passes.
constexpr std::int64_t followed_periods = 200;
// A state that comes back within this distance is where Newton's iteration begins.
constexpr double near_return = 0.1;

SegmentImpact impact_at(const GapState& state, double speed) {
  return {static_cast<double>(state.half_period) * pi - pi / 2 + state.s, speed, state.wall};
}

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
  const SteadyState steady = find_steady_state(motion, start, tolerance, {0, 0, transients});
  if (steady.regime != Regime::periodic && steady.regime != Regime::symmetric) return std::nullopt;
  const auto impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
  std::optional<OrbitSegment> found = orbit_through(motion, steady.end, impacts, 2 * steady.period);
  if (found) found->along = at.along;
  return found;
}

std::vector<OrbitSegment> orbits_passed(const OrbitSegment& at, const GapState& start, const OrbitLimits& limits) {
  const GapMotion motion(at.gamma(), at.restitution);
  struct NearReturn {
    double distance;
    std::size_t from;
  };
  std::map<std::pair<int, int>, NearReturn> nearest;  // by period and impacts
  std::vector<SegmentImpact> met;
  const std::int64_t last = start.half_period + 2 * followed_periods;
  for (GapState state = start; state.half_period < last;) {
    if (motion.rests(state) || motion.chatter_tail(state).negligible(tail_limit(motion, tolerance))) break;
    const Flight flight = motion.next_flight(state);
    if (!flight.hits) break;
    state = motion.after_impact(state, flight);
    met.push_back(impact_at(state, flight.speed));
    const SegmentImpact& to = met.back();
    for (int impacts = 1; impacts <= limits.impacts && static_cast<std::size_t>(impacts) < met.size(); ++impacts) {
      const std::size_t index = met.size() - 1 - static_cast<std::size_t>(impacts);
      const SegmentImpact& from = met[index];
      const double periods = std::round((to.phase - from.phase) / (2 * pi));
      if (periods > limits.period) break;
      if (periods < 1 || from.wall != to.wall) continue;
      const double distance =
          std::abs(to.phase - from.phase - 2 * pi * periods) + std::abs(to.speed - from.speed) / (1 + to.speed);
      if (distance > near_return) continue;
      const auto [known, is_new] =
          nearest.try_emplace(std::pair(static_cast<int>(periods), impacts), NearReturn{distance, index});
      if (!is_new && distance < known->second.distance) known->second = {distance, index};
    }
  }
  std::vector<OrbitSegment> found;
  for (const auto& [pattern, near] : nearest) {
    OrbitSegment guess = at;
    guess.half_periods = 2 * pattern.first;
    const auto first = met.begin() + static_cast<std::ptrdiff_t>(near.from) + 1;
    guess.impacts.assign(first, first + pattern.second);
    std::optional<OrbitSegment> orbit = corrected_to_shortest(guess);
    if (orbit && contact_margin(*orbit).margin > 0) found.push_back(std::move(*orbit));
  }
  return found;
}

}  // namespace backlash::detail
