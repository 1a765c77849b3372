// SPDX-License-Identifier: BSD-3-Clause
#include "compliant_family.hpp"

#include <cmath>
#include <limits>

#include "compliant_point.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"

namespace backlash::detail {
namespace {

using Eigen::VectorXd;
using Index = Eigen::Index;

VectorXd over_sizes(const CompliantFlow& flow, const VectorXd& state) {
  VectorXd result(static_cast<Index>(flow.repeating().size()));
  for (std::size_t i = 0; i < flow.repeating().size(); ++i) {
    const Index at = flow.repeating()[i];
    result[static_cast<Index>(i)] = state[at] / flow.sizes()[at];
  }
  return result;
}

}  // namespace

CompliantBodies CompliantFamily::bodies(double value) const {
  const TwoMassSystem& system = bodies_.system();
  const double clearance = parameter_ == OrbitParameter::clearance ? std::exp(value) : system.clearance();
  if (parameter_ != OrbitParameter::clearance && parameter_ != OrbitParameter::contact_frequency) return bodies_;
  const double mass1 = system.mass1(), mass2 = system.mass2();
  const CompliantContact contact =
      parameter_ == OrbitParameter::contact_frequency
          ? CompliantContact::from_frequency(std::exp(value),
                                             free_contact(bodies_.contact(), mass1, mass2).damping_ratio, mass1, mass2)
          : bodies_.contact();
  return {bodies_.hard().load(), bodies_.hard().drive(), clearance, contact, bodies_.friction()};
}

SineForce CompliantFamily::force(double value) const {
  SineForce force = force_;
  if (parameter_ == OrbitParameter::omega) force.omega = std::exp(value);
  if (parameter_ == OrbitParameter::force) force.amplitude = std::exp(value);
  return force;
}

CompliantFlow CompliantFamily::flow(double value) const {
  return {bodies(value), force(value), output_, compliant_realisation, 1};
}

MapAt CompliantFamily::map() const {
  return [this](const VectorXd& state, const CompliantMode& mode, double value, int steps) {
    return steps_from(state, mode, value, steps);
  };
}

std::optional<RepeatedMap> CompliantFamily::steps_from(const VectorXd& state, const CompliantMode& mode, double value,
                                                       int steps) const {
  const CompliantFlow at = flow(value);
  CompliantRun run(at, placed(at, state), mode);
  run.begin_transition();
  RepeatedMap result;
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

std::optional<ClosedMotion> CompliantFamily::settled(double value, const RelativeState& start) const {
  const CompliantBodies at = bodies(value);
  const auto [amplitude, omega] = force(value);
  SweepOptions options;
  options.output = output_;
  // What does not close is not wanted.
  options.mean_tolerance = std::numeric_limits<double>::max();
  CompliantPoint point(at, amplitude, omega, options);
  const auto reached = point.follow(start_about_mean(at.system(), amplitude, omega, start));
  if (reached.point.regime != Regime::periodic && reached.point.regime != Regime::symmetric) return std::nullopt;
  return closed_motion(map(), over_sizes(flow(value), reached.state), reached.mode, value, 2 * reached.point.period);
}

std::optional<ClosedMotion> CompliantFamily::from_hard(double value) const {
  const CompliantBodies at = bodies(value);
  const auto [amplitude, omega] = force(value);
  const ImpulseAnswer response(gap_response(at.hard()));
  const SymmetricForcedOrbit hard(at.hard(), response, amplitude, omega);
  if (!hard.exists()) return std::nullopt;
  const CompliantFlow flow = this->flow(value);
  const VectorXd state = flow.start(hard.at_peak());
  return closed_motion(map(), over_sizes(flow, state), flow.mode_of(state), value, 1);
}

VectorXd CompliantFamily::placed(const CompliantFlow& flow, const VectorXd& state) {
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

}  // namespace backlash::detail
