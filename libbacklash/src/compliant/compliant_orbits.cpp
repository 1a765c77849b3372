// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_orbits.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <vector>

#include "backlash/compliant/compliant_history.hpp"
#include "closed_motion_branch.hpp"
#include "compliant_point.hpp"
#include "continuation/continuation_scene.hpp"
#include "continuation/orbit_search.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"

namespace backlash {
namespace {

using detail::ClosedMotion;
using detail::ClosedMotionBranch;
using detail::ClosedMotionEnd;
using detail::ClosedMotionEvent;
using detail::CompliantFlow;
using detail::CompliantMode;
using detail::CompliantRun;
using detail::SineForce;
using Eigen::VectorXd;
using Index = Eigen::Index;

// Starts whose motion is followed until it settles, each at a value of the parameter of its own, and values at which
// the orbit of the restitution is tried.
constexpr std::size_t settling_starts = 256, hard_values = 32;
// Starts per side of the grid at a value of basins_at, as the command basins has them.
constexpr std::size_t basin_side = 41;

/// The scene at values of the logarithm of the parameter.
class CompliantFamily {
 public:
  CompliantFamily(const CompliantBodies& bodies, double force, double omega, OrbitParameter parameter, Output output)
      : bodies_(bodies), force_{force, omega}, parameter_(parameter), output_(output) {}

  [[nodiscard]] CompliantBodies bodies(double value) const {
    const TwoMassSystem& system = bodies_.system();
    const double clearance = parameter_ == OrbitParameter::clearance ? std::exp(value) : system.clearance();
    if (parameter_ != OrbitParameter::clearance && parameter_ != OrbitParameter::contact_frequency) return bodies_;
    const double mass1 = system.mass1(), mass2 = system.mass2();
    const CompliantContact contact =
        parameter_ == OrbitParameter::contact_frequency
            ? CompliantContact::from_frequency(
                  std::exp(value), free_contact(bodies_.contact(), mass1, mass2).damping_ratio, mass1, mass2)
            : bodies_.contact();
    return {bodies_.hard().load(), bodies_.hard().drive(), clearance, contact, bodies_.friction()};
  }
  [[nodiscard]] SineForce force(double value) const {
    SineForce force = force_;
    if (parameter_ == OrbitParameter::omega) force.omega = std::exp(value);
    if (parameter_ == OrbitParameter::force) force.amplitude = std::exp(value);
    return force;
  }
  [[nodiscard]] CompliantFlow flow(double value) const {
    return {bodies(value), force(value), output_, detail::compliant_realisation, 1};
  }

  /// Steps are half periods of the force, after which a state is turned over.
  [[nodiscard]] std::optional<detail::RepeatedMap> map(const VectorXd& state, const CompliantMode& mode, double value,
                                                       int steps) const {
    const CompliantFlow at = flow(value);
    CompliantRun run(at, placed(at, state), mode);
    run.begin_transition();
    detail::RepeatedMap result;
    for (int step = 1; step <= steps; ++step) {
      if (!follow(run, step, [&](CompliantRun::Event event) {
            result.pattern.contacts += event == CompliantRun::Event::contact;
            result.pattern.sticks += event == CompliantRun::Event::stick;
            result.pattern.reversals += event == CompliantRun::Event::reversal;
          }))
        return std::nullopt;
      result.visited.push_back((step % 2 == 0 ? 1.0 : -1.0) * over_sizes(at, run.state()));
    }
    const std::vector<Index>& repeating = at.repeating();
    const auto size = static_cast<Index>(repeating.size());
    result.derivative.resize(size, size);
    for (Index i = 0; i < size; ++i)
      for (Index k = 0; k < size; ++k) {
        const Index to = repeating[static_cast<std::size_t>(i)], of = repeating[static_cast<std::size_t>(k)];
        result.derivative(i, k) =
            (steps % 2 == 0 ? 1.0 : -1.0) * run.transition()(to, of) / at.sizes()[to] * at.sizes()[of];
      }
    result.mode = steps % 2 == 0 ? run.mode() : at.turned_over(run.mode());
    return result;
  }

  /// Closed where the motion is periodic.
  [[nodiscard]] std::optional<ClosedMotion> settled(const detail::MapAt& map, double value,
                                                    const RelativeState& start) const {
    const CompliantBodies at = bodies(value);
    const auto [amplitude, omega] = force(value);
    SweepOptions options;
    options.output = output_;
    // What does not close is not wanted.
    options.mean_tolerance = std::numeric_limits<double>::max();
    detail::CompliantPoint point(at, amplitude, omega, options);
    const auto reached = point.follow(start_about_mean(at.system(), amplitude, omega, start));
    if (reached.point.regime != Regime::periodic && reached.point.regime != Regime::symmetric) return std::nullopt;
    const CompliantFlow flow = this->flow(value);
    return closed_motion(map, over_sizes(flow, reached.state), reached.mode, value, 2 * reached.point.period);
  }
  /// What the symmetric orbit of the restitution becomes, if it becomes one as it is.
  [[nodiscard]] std::optional<ClosedMotion> from_hard(const detail::MapAt& map, double value) const {
    const CompliantBodies at = bodies(value);
    const auto [amplitude, omega] = force(value);
    const detail::ImpulseAnswer response(detail::gap_response(at.hard()));
    const detail::SymmetricForcedOrbit hard(at.hard(), response, amplitude, omega);
    if (!hard.exists()) return std::nullopt;
    const CompliantFlow flow = this->flow(value);
    const VectorXd state = flow.start(hard.at_peak());
    return closed_motion(map, over_sizes(flow, state), flow.mode_of(state), value, 1);
  }

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

  static VectorXd over_sizes(const CompliantFlow& flow, const VectorXd& state) {
    VectorXd result(static_cast<Index>(flow.repeating().size()));
    for (std::size_t i = 0; i < flow.repeating().size(); ++i) {
      const Index at = flow.repeating()[i];
      result[static_cast<Index>(i)] = state[at] / flow.sizes()[at];
    }
    return result;
  }
  static VectorXd placed(const CompliantFlow& flow, const VectorXd& state) {
    VectorXd result = VectorXd::Zero(flow.sizes().size());
    result[CompliantFlow::cosine] = result[CompliantFlow::one] = 1;
    for (std::size_t i = 0; i < flow.repeating().size(); ++i) {
      const Index at = flow.repeating()[i];
      result[at] = state[static_cast<Index>(i)] * flow.sizes()[at];
    }
    // At a peak of the force the centre of mass of free bodies turns.
    const TwoMassSystem& system = flow.bodies().system();
    if (flow.bodies().are_free())
      result[CompliantFlow::v1] = -system.mass2() / (system.mass1() + system.mass2()) * result[CompliantFlow::rate];
    return result;
  }
  /// To the end of half period number `step`. @return false where it has none
  template <class Visit>
  static bool follow(CompliantRun& run, int step, const Visit& visit) {
    const double until = step * std::numbers::pi / run.flow().omega();
    for (int events = 0; run.time() < until; ++events) {
      visit(run.advance(until));
      if (run.has_escaped() || run.is_spent() || events > CompliantRun::most_events) return false;
    }
    return true;
  }

  [[nodiscard]] PeriodicOrbit orbit(const ClosedMotion& motion) const {
    const double value = motion.parameter();
    const CompliantFlow at = flow(value);
    PeriodicOrbit result{};
    result.parameter = std::exp(value);
    result.omega = at.omega();
    CompliantRun run(at, placed(at, motion.state()), motion.mode);
    for (int step = 1; step <= 2 * periods(motion); ++step) {
      follow(run, step, [&](CompliantRun::Event event) {
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

  const CompliantBodies& bodies_;
  SineForce force_;
  OrbitParameter parameter_;
  Output output_;
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
  const detail::MapAt map = [&family](const VectorXd& state, const CompliantMode& mode, double value, int steps) {
    return family.map(state, mode, value, steps);
  };

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
    found[i] = start.state ? family.settled(map, start.value, *start.state) : family.from_hard(map, start.value);
    if (progress != nullptr) ++progress->done;
  });
  std::vector<ClosedMotion> through;
  for (auto& motion : found)
    if (motion) through.push_back(std::move(*motion));
  const detail::BranchLimits limits{low, high, 2 * options.longest_period, 1, options.most_impacts, true};
  OrbitDiagram diagram{bodies.system(), force_amplitude, omega, parameter, from, to, options, {}};
  for (const ClosedMotionBranch& branch : detail::closed_motion_branches(map, through, limits))
    diagram.branches.push_back(family.branch(branch));
  return diagram;
}

}  // namespace backlash
