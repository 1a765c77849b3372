// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_orbits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "compliant_family.hpp"
#include "continuation/continuation_scene.hpp"
#include "continuation/orbit_search.hpp"

namespace backlash {
namespace {

using detail::ClosedMotion;
using detail::ClosedMotionBranch;
using detail::ClosedMotionEnd;
using detail::ClosedMotionEvent;
using detail::CompliantFamily;
using detail::CompliantFlow;
using detail::CompliantRun;
using detail::SineForce;

// Starts whose motion is followed until it settles, each at a value of the parameter of its own, and values at which
// the orbit of the restitution is tried.
constexpr std::size_t settling_starts = 256, hard_values = 32;
// Starts per side of the grid at a value of basins_at, as the command basins has them.
constexpr std::size_t basin_side = 41;

/// What a diagram tells of closed motions.
class Diagram {
 public:
  explicit Diagram(const CompliantFamily& family) : family_(family) {}

  [[nodiscard]] OrbitBranch branch(const ClosedMotionBranch& of) const {
    const ClosedMotion& first = of.motions.front();
    OrbitBranch result{};
    result.symmetric = first.steps % 2 != 0;
    result.period = periods(first);
    result.impacts = static_cast<int>(first.map.pattern.contacts) * (result.symmetric ? 2 : 1);
    for (const ClosedMotion& motion : of.motions) result.orbits.push_back(orbit(motion));
    for (const auto& event : of.events) result.bifurcations.push_back({kind(event), orbit(event.motion), event.after});
    result.begin = end(first, of.begin);
    result.end = end(first, of.end);
    const auto kink = [&](BranchEnd at, const PeriodicOrbit& orbit, std::size_t after) {
      if (at != BranchEnd::grazing && at != BranchEnd::sticking) return;
      const Bifurcation kind = at == BranchEnd::grazing ? Bifurcation::grazing : Bifurcation::sticking;
      result.bifurcations.insert(after == 0 ? result.bifurcations.begin() : result.bifurcations.end(),
                                 {kind, orbit, after});
    };
    kink(result.end, result.orbits.back(), result.orbits.size() - 1);
    kink(result.begin, result.orbits.front(), 0);
    return result;
  }

 private:
  static int periods(const ClosedMotion& motion) { return motion.steps % 2 != 0 ? motion.steps : motion.steps / 2; }

  [[nodiscard]] PeriodicOrbit orbit(const ClosedMotion& motion) const {
    const double value = motion.parameter();
    const CompliantFlow at = family_.flow(value);
    PeriodicOrbit result{};
    result.parameter = std::exp(value);
    result.omega = at.omega();
    CompliantRun run(at, CompliantFamily::placed(at, motion.state()), motion.mode);
    for (int step = 1; step <= 2 * periods(motion); ++step) {
      CompliantFamily::follow(run, step, [&](CompliantRun::Event event) {
        if (event != CompliantRun::Event::contact) return;
        result.impacts.push_back({run.time() * at.omega(), run.subject() > 0 ? Wall::far : Wall::near,
                                  std::max(0.0, run.subject() * run.state()[CompliantFlow::rate])});
      });
    }
    run.begin_anew(periods(motion));
    result.value = run.phasors().front() / std::complex<double>(0, at.omega()) / at.force();
    const auto multipliers = motion.multipliers();
    for (std::size_t i = 0; i < 2; ++i)
      result.multipliers[i] = motion.steps % 2 != 0 ? multipliers[i] * multipliers[i] : multipliers[i];
    result.stable = std::abs(result.multipliers[0]) < 1;
    return result;
  }

  static Bifurcation kind(const ClosedMotionBranch::EventAt& event) {
    if (event.kind == ClosedMotionEvent::fold) return Bifurcation::saddle_node;
    return event.motion.steps % 2 != 0 ? Bifurcation::symmetry_breaking : Bifurcation::period_doubling;
  }
  static BranchEnd end(const ClosedMotion& first, ClosedMotionEnd end) {
    switch (end) {
      case ClosedMotionEnd::range:
        return BranchEnd::range;
      case ClosedMotionEnd::contact:
        return BranchEnd::grazing;
      case ClosedMotionEnd::friction:
        return BranchEnd::sticking;
      case ClosedMotionEnd::birth:
        return first.steps / 2 % 2 != 0 ? BranchEnd::symmetry_breaking : BranchEnd::period_doubling;
      case ClosedMotionEnd::closed:
        return BranchEnd::closed;
      case ClosedMotionEnd::lost:
        return BranchEnd::lost;
      case ClosedMotionEnd::too_long:
        break;
    }
    return BranchEnd::too_long;
  }

  const CompliantFamily& family_;
};

}  // namespace

OrbitDiagram orbit_diagram(const CompliantBodies& bodies, double force_amplitude, double omega,
                           OrbitParameter parameter, double from, double to, const OrbitContinuationOptions& options,
                           frac::Progress* progress) {
  if (parameter == OrbitParameter::restitution)
    throw std::invalid_argument(
        "parameter is restitution; with contacts that take time it must be omega, force, clearance or "
        "contact-frequency");
  detail::require_diagram(bodies.system(), force_amplitude, omega, parameter, from, to, options);
  const CompliantFamily family(bodies, force_amplitude, omega, parameter, options.output);
  for (const double end : {from, to})
    detail::require_followed(family.bodies(std::log(end)), family.force(std::log(end)).omega);
  const double low = std::log(from), high = std::log(to);

  struct Start {
    double value;
    std::optional<RelativeState> state;  // none: that of the restitution
  };
  std::vector<Start> starts;
  const auto at_value = [&](double share) { return low + share * (high - low); };
  for (std::size_t i = 0; i < hard_values; ++i)
    starts.push_back({at_value((static_cast<double>(i) + 0.5) / static_cast<double>(hard_values)), std::nullopt});
  // Velocities as those of starts with a restitution.
  const auto add = [&](double value, double position, double velocity, double fastest) {
    const SineForce force = family.force(value);
    const TwoMassSystem system = family.bodies(value).system();
    const double gamma = force.amplitude / (system.mass2() * system.clearance() * force.omega * force.omega);
    const double speed = fastest * std::max(1.0, fastest > 1 ? std::cbrt(gamma) : 0);
    starts.push_back(
        {value, RelativeState{position * system.clearance(), speed * velocity * system.clearance() * force.omega}});
  };
  for (std::size_t i = 0; i < settling_starts; ++i) {
    const detail::SearchStart start = detail::search_start(i);
    constexpr double most_speed = 1.5;
    add(at_value(start.share), start.position, start.velocity, most_speed);
  }
  for (const double value : options.basins_at) {
    const auto share = [](std::size_t k) { return static_cast<double>(k) / (basin_side - 1); };
    for (std::size_t i = 0; i < basin_side * basin_side; ++i)
      add(std::log(value), share(i / basin_side), 2 * share(i % basin_side) - 1, 1);
  }
  std::vector<std::optional<ClosedMotion>> found(starts.size());
  if (progress != nullptr) progress->total += starts.size();
  frac::parallel_for(starts.size(), options.threads, [&](std::size_t i) {
    const Start& start = starts[i];
    found[i] = start.state ? family.settled(start.value, *start.state) : family.from_hard(start.value);
    if (progress != nullptr) ++progress->done;
  });
  std::vector<ClosedMotion> through;
  for (auto& motion : found)
    if (motion) through.push_back(std::move(*motion));
  const detail::BranchLimits limits{low, high, 2 * options.longest_period, 1, options.most_impacts, true};
  OrbitDiagram diagram{bodies.system(), force_amplitude, omega, parameter, from, to, options, {}};
  for (const ClosedMotionBranch& branch : detail::closed_motion_branches(family.map(), through, limits))
    diagram.branches.push_back(Diagram(family).branch(branch));
  return diagram;
}

}  // namespace backlash
