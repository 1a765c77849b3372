// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "compliant_flow.hpp"

namespace backlash::detail {

/// Events of a motion.  Where they stay the same it depends smoothly on its start; where one is gained or lost a wall
/// or a rest is just touched, and the motion is continuous with a kink, as a contact with damping pushes at once.
struct MotionPattern {
  std::int64_t contacts = 0;   // times that a wall begins to press
  std::int64_t sticks = 0;     // times that dry friction brings a body to rest
  std::int64_t reversals = 0;  // times that a body turns under dry friction without a rest

  bool operator==(const MotionPattern&) const = default;
};

/// Some steps of a map whose fixed points are closed motions.
struct RepeatedMap {
  std::vector<Eigen::VectorXd> visited;  // state after each step, over its sizes
  CompliantMode mode;                    // after the last
  Eigen::MatrixXd derivative;            // of the last state by the first
  MotionPattern pattern;                 // of all steps
};
/// So many steps from a state over its sizes, at a value of the parameter.  Empty where the motion has no end.
using MapAt =
    std::function<std::optional<RepeatedMap>(const Eigen::VectorXd& state, const CompliantMode&, double value, int)>;

/// A closed motion, and how it changes along the branch that it lies on.
struct ClosedMotion {
  Eigen::VectorXd at;  // state over its sizes, then the parameter
  CompliantMode mode;
  int steps;
  Eigen::VectorXd tangent;  // of length 1
  RepeatedMap map;

  [[nodiscard]] double parameter() const { return at[at.size() - 1]; }
  [[nodiscard]] Eigen::VectorXd state() const { return at.head(at.size() - 1); }
  /// Of the map over all steps, larger modulus first.
  [[nodiscard]] std::vector<std::complex<double>> multipliers() const;
};

/// The closed motion at a value of the parameter next to a state, over the fewest steps, by Newton's method.
[[nodiscard]] std::optional<ClosedMotion> closed_motion(const MapAt& map, const Eigen::VectorXd& state,
                                                        const CompliantMode& mode, double value, int steps);

enum class ClosedMotionEvent { fold, flip, birth };  // as SegmentEvent
enum class ClosedMotionEnd { range, contact, friction, birth, closed, lost, too_long };

/// Closed motions of one pattern, in order.
struct ClosedMotionBranch {
  struct EventAt {
    ClosedMotionEvent kind;
    ClosedMotion motion;  // at a birth that of the halves
    std::size_t after;    // index of the last motion before it
  };
  std::vector<ClosedMotion> motions;
  std::vector<EventAt> events;
  ClosedMotionEnd begin, end;
  std::vector<ClosedMotion> beyond;  // past kinks at its ends, where it goes on with another pattern
};

/// Which branches are wanted.
struct BranchLimits {
  double lower, upper;           // of the parameter
  int most_steps;                // of a closed motion and its mirror image together
  std::int64_t fewest_contacts;  // of these
  std::int64_t most_contacts;
  bool mirrors;  // an odd number of steps leads to the mirror image
};

/// The branches through these motions, and those that hang together with them where they are stable, by flips, births
/// and kinks.
[[nodiscard]] std::vector<ClosedMotionBranch> closed_motion_branches(const MapAt& map,
                                                                     const std::vector<ClosedMotion>& through,
                                                                     const BranchLimits& limits);

}  // namespace backlash::detail
