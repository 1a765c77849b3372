// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <numbers>
#include <optional>

#include "backlash/compliant/compliant_history.hpp"
#include "backlash/orbit_continuation.hpp"
#include "closed_motion_branch.hpp"
#include "compliant_run.hpp"

namespace backlash::detail {

/// Bodies with compliant contacts under a sine force, at values of the logarithm of a parameter; their closed motions
/// are fixed points of the map over half periods of the force, after each of which a state is turned over.
class CompliantFamily {
 public:
  /// Refers to `bodies`.
  CompliantFamily(const CompliantBodies& bodies, double force, double omega, OrbitParameter parameter, Output output)
      : bodies_(bodies), force_{force, omega}, parameter_(parameter), output_(output) {}

  [[nodiscard]] CompliantBodies bodies(double value) const;
  [[nodiscard]] SineForce force(double value) const;
  [[nodiscard]] CompliantFlow flow(double value) const;
  /// Refers to this.
  [[nodiscard]] MapAt map() const;

  /// Closed where the motion is periodic.
  [[nodiscard]] std::optional<ClosedMotion> settled(double value, const RelativeState& start) const;
  /// What the symmetric orbit of the restitution becomes, if it becomes one as it is.
  [[nodiscard]] std::optional<ClosedMotion> from_hard(double value) const;

  /// The state of the flow at a state of the map.
  [[nodiscard]] static Eigen::VectorXd placed(const CompliantFlow& flow, const Eigen::VectorXd& state);
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

 private:
  [[nodiscard]] std::optional<RepeatedMap> steps_from(const Eigen::VectorXd& state, const CompliantMode& mode,
                                                      double value, int steps) const;

  const CompliantBodies& bodies_;
  SineForce force_;
  OrbitParameter parameter_;
  Output output_;
};

}  // namespace backlash::detail
