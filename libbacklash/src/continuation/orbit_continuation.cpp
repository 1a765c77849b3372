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
#include "orbit_correction.hpp"
#include "orbit_search.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash {
namespace {

using detail::OrbitSegment;

constexpr double pi = std::numbers::pi;

constexpr std::array<std::pair<OrbitParameter, std::string_view>, 5> parameters = {{
    {OrbitParameter::omega, "omega"},
    {OrbitParameter::force, "force"},
    {OrbitParameter::clearance, "clearance"},
    {OrbitParameter::restitution, "restitution"},
    {OrbitParameter::contact_frequency, "contact-frequency"},
}};
constexpr std::array<std::pair<Bifurcation, std::string_view>, 5> bifurcations = {{
    {Bifurcation::saddle_node, "saddle-node"},
    {Bifurcation::symmetry_breaking, "symmetry-breaking"},
    {Bifurcation::period_doubling, "period-doubling"},
    {Bifurcation::grazing, "grazing"},
    {Bifurcation::sticking, "sticking"},
}};
constexpr std::array<std::pair<BranchEnd, std::string_view>, 8> branch_ends = {{
    {BranchEnd::range, "range"},
    {BranchEnd::grazing, "grazing"},
    {BranchEnd::sticking, "sticking"},
    {BranchEnd::symmetry_breaking, "symmetry-breaking"},
    {BranchEnd::period_doubling, "period-doubling"},
    {BranchEnd::closed, "closed"},
    {BranchEnd::lost, "lost"},
    {BranchEnd::too_long, "too-long"},
}};

// Starts whose motion is followed until it settles, each at a value of the parameter of its own: so an orbit that most
// starts lead to over a thousandth of the range is met as surely as one that a thousandth of all starts lead to.
constexpr std::size_t settling_starts = 1024;
// Starts that are followed for the orbits their motion passes.
constexpr std::size_t passing_starts = 512;
// What is looked for among those passed: unstable orbits of longer periods are without number.
constexpr detail::OrbitLimits longest_passed{8, 32};
// Starts per side of the grid at a value of basins_at, as the command basins has them.
constexpr std::size_t basin_side = 41;
// Values at which the symmetric two-impact orbit is looked for.
constexpr std::size_t two_impact_values = 96;

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
  const std::string unit = parameter == OrbitParameter::force       ? "N"
                           : parameter == OrbitParameter::clearance ? "m"
                                                                    : "rad/s";
  detail::require_positive(name + "_from", unit, from);
  detail::require_positive(name + "_to", unit, to);
  if (!(from < to)) {
    throw std::invalid_argument(name + "_from is " + detail::text(from) + "; it must be less than " + name +
                                "_to = " + detail::text(to) + " (" + unit + ")");
  }
}

// The orbits that the grid of starts at one value settles on, each once or more often.
std::vector<OrbitSegment> basin_orbits(const OrbitSegment& at, int threads) {
  const detail::GapMotion motion(at.gamma(), at.restitution);
  std::vector<std::optional<OrbitSegment>> settled(basin_side * basin_side);
  frac::parallel_for(settled.size(), threads, [&](std::size_t i) {
    const auto share = [](std::size_t k) { return static_cast<double>(k) / (basin_side - 1); };
    const detail::DistanceAndVelocity start{share(i / basin_side), 2 * share(i % basin_side) - 1};
    settled[i] = detail::settled_orbit(at, motion.peak_state(0, start), detail::Transients::outlasted);
  });
  std::vector<OrbitSegment> found;
  for (auto& orbit : settled) {
    if (orbit) found.push_back(std::move(*orbit));
  }
  return found;
}

}  // namespace

void detail::require_diagram(const TwoMassSystem& system, double force_amplitude, double omega,
                             OrbitParameter parameter, double from, double to,
                             const OrbitContinuationOptions& options) {
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
  for (const double value : options.basins_at) {
    if (value >= from && value <= to) continue;
    throw std::invalid_argument("basins_at holds " + detail::text(value) + "; it must lie within " +
                                detail::text(from) + " to " + detail::text(to));
  }
}

std::string_view to_string(OrbitParameter parameter) {
  return frac::detail::spelling(parameters, parameter);
}
std::string_view to_string(Bifurcation bifurcation) {
  return frac::detail::spelling(bifurcations, bifurcation);
}
std::string_view to_string(BranchEnd end) {
  return frac::detail::spelling(branch_ends, end);
}
OrbitParameter orbit_parameter_from_string(std::string_view text) {
  return frac::detail::from_spelling(parameters, "parameter", text);
}
std::span<const OrbitParameter> orbit_parameters() {
  static constexpr auto all = frac::detail::enumerators(parameters);
  return all;
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
  if (parameter == OrbitParameter::contact_frequency)
    throw std::invalid_argument(
        "parameter is contact-frequency; contacts with a restitution take no time and have none");
  detail::require_diagram(system, force_amplitude, omega, parameter, from, to, options);
  const detail::ContinuationScene scene(system, force_amplitude, omega, parameter, options.output);
  const detail::ParameterRange range = scene.range(from, to);
  const auto motion_at = [&](double share) {
    return scene.motion_at(range.upper + share * (range.lower - range.upper));
  };
  const detail::OrbitLimits limits{std::min(options.longest_period, longest_passed.period),
                                   std::min(options.most_impacts, longest_passed.impacts)};
  std::vector<std::optional<OrbitSegment>> settled(settling_starts);
  std::vector<std::vector<OrbitSegment>> passed(passing_starts);
  if (progress != nullptr) progress->total += settling_starts + passing_starts;
  frac::parallel_for(settling_starts + passing_starts, options.threads, [&](std::size_t i) {
    const detail::SearchStart start = detail::search_start(i);
    const OrbitSegment at = motion_at(start.share);
    if (i < settling_starts) {
      const detail::GapState state = state_of(start, detail::GapMotion(at.gamma(), at.restitution));
      // What a motion passes on a long transient orbits_passed finds sooner.
      settled[i] = detail::settled_orbit(at, state, detail::Transients::ignored);
    } else {
      passed[i - settling_starts] = detail::orbits_passed(at, i, limits);
    }
    if (progress != nullptr) ++progress->done;
  });
  detail::BranchExplorer explorer(range, options);
  // The symmetric two-impact orbit attracts nothing at restitution 1 or at low frequency.
  for (std::size_t i = 0; i < two_impact_values; ++i) {
    const double share = 1 - (static_cast<double>(i) + 0.5) / static_cast<double>(two_impact_values);
    if (const auto orbit = two_impact(motion_at(share))) explorer.follow(*orbit);
  }
  for (const auto& orbit : settled) {
    if (orbit) explorer.follow(*orbit);
  }
  for (const double value : options.basins_at) {
    for (const OrbitSegment& orbit : basin_orbits(scene.motion_at(scene.range(value, value).lower), options.threads)) {
      explorer.follow(orbit);
    }
  }
  for (const auto& orbits : passed) {
    for (const OrbitSegment& orbit : orbits) explorer.follow_if_stable(orbit);
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
