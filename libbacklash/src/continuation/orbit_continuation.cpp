// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/orbit_continuation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "branch_explorer.hpp"
#include "continuation_scene.hpp"
#include "motion/gap_motion.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash {
namespace {

using detail::OrbitSegment;

constexpr double pi = std::numbers::pi;

constexpr std::array<std::pair<OrbitParameter, std::string_view>, 4> parameters = {{
    {OrbitParameter::omega, "omega"},
    {OrbitParameter::force, "force"},
    {OrbitParameter::clearance, "clearance"},
    {OrbitParameter::restitution, "restitution"},
}};
constexpr std::array<std::pair<Bifurcation, std::string_view>, 4> bifurcations = {{
    {Bifurcation::saddle_node, "saddle-node"},
    {Bifurcation::symmetry_breaking, "symmetry-breaking"},
    {Bifurcation::period_doubling, "period-doubling"},
    {Bifurcation::grazing, "grazing"},
}};
constexpr std::array<std::pair<BranchEnd, std::string_view>, 7> branch_ends = {{
    {BranchEnd::range, "range"},
    {BranchEnd::grazing, "grazing"},
    {BranchEnd::symmetry_breaking, "symmetry-breaking"},
    {BranchEnd::period_doubling, "period-doubling"},
    {BranchEnd::closed, "closed"},
    {BranchEnd::lost, "lost"},
    {BranchEnd::too_long, "too-long"},
}};

// Values of the parameter at which attractors are looked for, each from mid-gap and from contact at rest and from
// starts spread over positions and velocities: an orbit that 20 % of all starts settle on at one value only is missed
// with a probability of 4 %.
constexpr std::size_t seed_values = 96;
constexpr std::size_t seed_starts = 16;
// Speeds of impacts are of the order of the clearance times omega, larger under strong forces.
constexpr double most_seed_speed = 1.5;

detail::GapState seed_start(const detail::GapMotion& motion, std::size_t value, std::size_t start) {
  if (start == 0) return detail::state_at_peak(0.5, 0);
  if (start == 1) return detail::state_at_peak(0, 0);
  // Points of a plane that fill it evenly, one after the other (Roberts 2018), never the same at two values.
  const auto place = static_cast<double>(value * seed_starts + start);
  const double position = std::fmod(0.5 + 0.7548776662466927 * place, 1.0);
  const double speed = most_seed_speed * std::max(1.0, std::cbrt(motion.gamma()));
  return motion.peak_state(0, {position, speed * (2 * std::fmod(0.5 + 0.5698402909980532 * place, 1.0) - 1)});
}

// The orbit that the motion from a start settles on, where it is a closed one without rests.
std::optional<OrbitSegment> settled(const OrbitSegment& at, std::size_t value, std::size_t index) {
  const detail::GapMotion motion(at.gamma(), at.restitution);
  const detail::GapState start = seed_start(motion, value, index);
  const detail::SteadyState steady =
      detail::find_steady_state(motion, start, 1e-10, {0, 0, detail::Transients::ignored});
  if (steady.regime != Regime::periodic && steady.regime != Regime::symmetric) return std::nullopt;
  const auto impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
  std::optional<OrbitSegment> found = detail::orbit_through(motion, steady.end, impacts, 2 * steady.period);
  if (found) found->along = at.along;
  return found;
}

// The half of the symmetric two-impact orbit, in closed form.
std::optional<OrbitSegment> two_impact(OrbitSegment at) {
  const auto orbit = detail::symmetric_two_impact_orbit(at.gamma(), at.restitution);
  if (!orbit) return std::nullopt;
  const double phase = static_cast<double>(orbit->start.half_period) * pi - pi / 2 + orbit->start.s;
  at.half_periods = 1;
  at.impacts = {{phase, orbit->speed, orbit->start.wall}};
  return detail::corrected(at, detail::parameter_direction(at));
}

void require_range(OrbitParameter parameter, double from, double to) {
  const std::string name(to_string(parameter));
  if (parameter == OrbitParameter::restitution) {
    if (!(from >= 0 && from < to && to <= 1)) {
      throw std::invalid_argument(name + " from " + detail::text(from) + " to " + detail::text(to) +
                                  "; must be 0 <= from < to <= 1");
    }
    return;
  }
  const std::string unit = parameter == OrbitParameter::omega   ? "rad/s"
                           : parameter == OrbitParameter::force ? "N"
                                                                : "m";
  detail::require_positive(name + "_from", unit, from);
  detail::require_positive(name + "_to", unit, to);
  if (!(from < to)) {
    throw std::invalid_argument(name + "_from is " + detail::text(from) + "; it must be less than " + name +
                                "_to = " + detail::text(to) + " (" + unit + ")");
  }
}

void check(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter, double from,
           double to, const OrbitContinuationOptions& options) {
  if (parameter != OrbitParameter::force) detail::require_positive("force_amplitude", "N", force_amplitude);
  if (parameter != OrbitParameter::clearance) detail::require_positive("clearance", "m", system.clearance());
  if (parameter != OrbitParameter::omega) detail::require_positive("omega", "rad/s", omega);
  require_range(parameter, from, to);
  for (const auto& [name, value, least] :
       {std::tuple{"longest_period", options.longest_period, 1}, std::tuple{"most_impacts", options.most_impacts, 2},
        std::tuple{"threads", options.threads, 0}}) {
    if (value < least) {
      throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; it must be at least " +
                                  std::to_string(least));
    }
  }
}

}  // namespace

std::string_view to_string(OrbitParameter parameter) {
  return detail::spelling(parameters, parameter);
}
std::string_view to_string(Bifurcation bifurcation) {
  return detail::spelling(bifurcations, bifurcation);
}
std::string_view to_string(BranchEnd end) {
  return detail::spelling(branch_ends, end);
}
OrbitParameter orbit_parameter_from_string(std::string_view text) {
  return detail::from_spelling(parameters, "parameter", text);
}
std::span<const OrbitParameter> orbit_parameters() {
  static constexpr auto all = detail::enumerators(parameters);
  return all;
}
Bifurcation bifurcation_from_string(std::string_view text) {
  return detail::from_spelling(bifurcations, "bifurcation", text);
}
BranchEnd branch_end_from_string(std::string_view text) {
  return detail::from_spelling(branch_ends, "branch end", text);
}

PeriodicOrbit mirror_twin(const PeriodicOrbit& orbit, int period) {
  PeriodicOrbit twin = orbit;
  for (OrbitImpact& impact : twin.impacts) {
    impact.phase = std::fmod(impact.phase + pi, 2 * pi * period);
    impact.wall = impact.wall == Wall::near ? Wall::far : Wall::near;
  }
  std::sort(twin.impacts.begin(), twin.impacts.end(),
            [](const OrbitImpact& a, const OrbitImpact& b) { return a.phase < b.phase; });
  return twin;
}

OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter,
                           double from, double to, const OrbitContinuationOptions& options, frac::Progress* progress) {
  check(system, force_amplitude, omega, parameter, from, to, options);
  const detail::ContinuationScene scene(system, force_amplitude, omega, parameter, options.output);
  const detail::ParameterRange range = scene.range(from, to);
  const auto motion_at = [&](std::size_t i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(seed_values);
    return scene.motion_at(range.upper + share * (range.lower - range.upper));
  };
  std::vector<std::optional<OrbitSegment>> seeds(seed_values * seed_starts);
  if (progress != nullptr) progress->total += seeds.size();
  frac::parallel_for(seeds.size(), options.threads, [&](std::size_t i) {
    seeds[i] = settled(motion_at(i / seed_starts), i / seed_starts, i % seed_starts);
    if (progress != nullptr) ++progress->done;
  });
  detail::BranchExplorer explorer(range, options);
  // The symmetric two-impact orbit attracts nothing at restitution 1 or at low frequency.
  for (std::size_t i = 0; i < seed_values; ++i) {
    if (const auto orbit = two_impact(motion_at(seed_values - 1 - i))) explorer.follow(*orbit);
  }
  for (const auto& seed : seeds) {
    if (seed) explorer.follow(*seed);
  }
  OrbitDiagram diagram{system, force_amplitude, omega, parameter, from, to, options, {}};
  for (const detail::SegmentBranch& branch : explorer.take()) diagram.branches.push_back(scene.branch(branch));
  return diagram;
}

OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega_from, double omega_to,
                           const OrbitContinuationOptions& options, frac::Progress* progress) {
  return orbit_diagram(system, force_amplitude, omega_from, OrbitParameter::omega, omega_from, omega_to, options,
                       progress);
}

}  // namespace backlash
