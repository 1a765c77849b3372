// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>

#include "base/check.hpp"
#include "describing_function_point.hpp"
#include "steady_state.hpp"

namespace backlash {
namespace {

// Phasors of one closed orbit agree to this over all starts.
constexpr double same_orbit = 1e-6;
// Force periods that a start is followed at most.
constexpr double longest_course = 100'000;
// Averaged starts that are followed on, of each scene, where no start has settled.
constexpr std::size_t probes = 16;

void check(const TwoMassSystem& system, double gamma, const std::vector<double>& position,
           const std::vector<double>& velocity) {
  detail::require_positive("clearance", "m", system.clearance());
  if (!(gamma > detail::free_force && gamma < detail::rigid_force)) {
    throw std::invalid_argument("F/(M2 clearance omega^2) is " + detail::text(gamma) + "; it must be in (1e-30, 1e30)");
  }
  if (position.empty()) throw std::invalid_argument("position is empty; it must hold at least one value");
  if (velocity.empty()) throw std::invalid_argument("velocity is empty; it must hold at least one value");
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (!(position[i] >= 0 && position[i] <= system.clearance())) {
      throw std::invalid_argument("position[" + std::to_string(i) + "] is " + detail::text(position[i]) +
                                  "; it must be in [0, clearance = " + detail::text(system.clearance()) + "] (m)");
    }
  }
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (!std::isfinite(velocity[i])) {
      throw std::invalid_argument("velocity[" + std::to_string(i) + "] is " + detail::text(velocity[i]) +
                                  "; it must be finite (m/s)");
    }
  }
}

bool is_mean(const detail::SteadyState& steady) {
  return steady.regime == Regime::averaged;
}

bool same(const detail::SteadyState& a, const detail::SteadyState& b) {
  if (a.regime == Regime::free || b.regime == Regime::free) return a.regime == b.regime;
  if (is_mean(a) || is_mean(b)) {
    return is_mean(a) && is_mean(b) && std::abs(a.harmonics.u[0] - b.harmonics.u[0]) <= a.uncertainty + b.uncertainty;
  }
  if (a.period != b.period || a.impacts_per_period != b.impacts_per_period) return false;
  if (std::abs(a.harmonics.u[0] - b.harmonics.u[0]) > same_orbit) return false;
  // Even harmonics of mirror twins have opposite signs.  An orbit of several periods seen from another one of them has
  // the same phasors.
  return std::abs(a.harmonics.u[detail::second_harmonic] - b.harmonics.u[detail::second_harmonic]) <= same_orbit;
}

bool is_symmetric(const detail::SteadyState& steady) {
  const double limit = is_mean(steady) ? steady.uncertainty : same_orbit;
  return std::abs(steady.harmonics.u[detail::second_harmonic]) <= limit;
}

// Follows a motion on from where it was left until it is known that it is no transient, or for long enough.
detail::SteadyState followed_on(const detail::GapMotion& motion, detail::SteadyState steady,
                                const SweepOptions& options) {
  double periods = steady.periods_followed;
  while (steady.transient_possible && periods < longest_course) {
    steady = detail::find_steady_state(motion, steady.end, options.tolerance);
    periods += steady.periods_followed;
    if (is_mean(steady)) steady.periods_followed = periods;
  }
  return steady;
}

// Chaos that lasts over the usual window may be a transient.  Where starts settle on orbits all averaged ones are
// followed on; where none does, a sample of them tells whether there is something to settle on.
void outlast_transients(const detail::GapMotion& motion, std::vector<detail::SteadyState>& found,
                        const SweepOptions& options) {
  std::vector<std::size_t> means;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i].transient_possible) means.push_back(i);
  }
  const auto follow = [&](std::size_t first, std::size_t last) {
    frac::parallel_for(last - first, options.threads, [&](std::size_t i) {
      detail::SteadyState& steady = found[means[first + i]];
      steady = followed_on(motion, steady, options);
    });
  };
  std::size_t begin = 0;
  if (means.size() == found.size()) {
    begin = std::min(probes, means.size());
    follow(0, begin);
    if (std::all_of(means.begin(), means.begin() + static_cast<std::ptrdiff_t>(begin),
                    [&](std::size_t i) { return is_mean(found[i]); })) {
      return;
    }
  }
  follow(begin, means.size());
}

}  // namespace

BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega, const std::vector<double>& position,
                const std::vector<double>& velocity, const SweepOptions& options, frac::Progress* progress) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  check(system, gamma, position, velocity);
  detail::require_valid(options);
  const detail::GapMotion motion(gamma, system.restitution());
  const std::size_t starts = position.size() * velocity.size();
  if (progress != nullptr) progress->total += starts;
  std::vector<detail::SteadyState> found(starts);
  frac::parallel_for(starts, options.threads, [&](std::size_t i) {
    const detail::GapState start = motion.peak_state(0, {position[i / velocity.size()] / system.clearance(),
                                                         velocity[i % velocity.size()] / (system.clearance() * omega)});
    detail::MeanGoal goal = detail::mean_goal(system, gamma, options);
    goal.transients = detail::Transients::ignored;
    found[i] = detail::find_steady_state(motion, start, options.tolerance, goal);
    if (progress != nullptr) ++progress->done;
  });
  outlast_transients(motion, found, options);

  BasinMap map{system, force_amplitude, omega, position, velocity, {}, {}};
  std::vector<std::size_t> first;  // start that led to each attractor first
  std::vector<std::size_t> count;
  for (std::size_t i = 0; i < starts; ++i) {
    const auto known =
        std::find_if(first.begin(), first.end(), [&](std::size_t other) { return same(found[i], found[other]); });
    const auto index = static_cast<std::size_t>(known - first.begin());
    if (known == first.end()) {
      first.push_back(i);
      count.push_back(0);
    }
    ++count[index];
    map.attractor.push_back(index);
  }
  std::vector<std::size_t> order(first.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
  std::vector<std::size_t> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    const detail::SteadyState& steady = found[first[order[i]]];
    map.attractors.push_back(
        {detail::point_of(system, omega, gamma, options.output, steady), is_symmetric(steady), count[order[i]]});
  }
  for (std::size_t& index : map.attractor) index = rank[index];
  return map;
}

}  // namespace backlash
