// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <string_view>
#include <vector>

#include "backlash/impact_simulation.hpp"
#include "backlash/loops/control_loop.hpp"

namespace backlash {

/// Start of a loop.  Until t = 0 the bodies have rested at these positions, so that derivatives know of no step there;
/// integrals begin at 0.
struct LoopStart {
  double x1 = 0;  // m
  double v1 = 0;  // m/s
  double x2 = 0;  // m, with |x2 - x1| <= clearance/2
  double v2 = 0;  // m/s
};

/// A point of a set-point that is straight from point to point.
struct SetPointKnot {
  double time;   // s
  double value;  // m
};

/// What the measured position should be from t = 0 on: step + ramp t + a sine + the line through the knots, which
/// begins at time 0 and stays where it ends.  The controller gets the difference, derivatives too.
struct SetPoint {
  double step = 0;            // m
  double ramp = 0;            // m/s
  double sine_amplitude = 0;  // m
  double sine_omega = 0;      // rad/s, > 0 with an amplitude
  std::vector<SetPointKnot> knots = {};
  /// s, >= 0: all of it passes 1/(lag s + 1) before the controller gets it.  A position controller K1 around a speed
  /// controller K2 (1 + 1/(T s)) leaves the derivative to the position: its force K2 (1 + 1/(T s)) (K1 (r - x) - s x)
  /// is C (r/(lag s + 1) - x) with C = K2 (1 + 1/(T s)) (K1 + s) and the lag 1/K1, from a start at 0.
  double lag = 0;
};

/// Constant forces on the bodies from t = 0 on, N: a torque of the load, weight.
struct Disturbance {
  double body1 = 0;
  double body2 = 0;
};

/// contact: the bodies stay at a wall together from there on; release: until there.
enum class LoopEvent { sample, before_impact, after_impact, contact, release };
[[nodiscard]] std::string_view to_string(LoopEvent event);

struct LoopRow {
  double time;   // s
  double x1;     // m
  double v1;     // m/s
  double x2;     // m
  double v2;     // m/s
  double force;  // N, of the controller on mass 2; infinite where a derivative meets a step
  LoopEvent event;
};

struct LoopImpact {
  double time;   // s
  Wall wall;     // near: x2 - x1 = -clearance/2
  double speed;  // m/s, of the masses towards each other
};

/// Why a simulation ended.
enum class LoopEnd {
  duration,      // as asked for
  rest,          // the masses stay in contact, or impacts follow each other without end, where that is not followed
  most_impacts,  // as many as were allowed
  most_flights,  // 2 10^7 pieces of the motion without an impact: the loop is too fast for the duration
  diverged,      // the motion is 10^9 times as wide as the clearance or its set-point
};
[[nodiscard]] std::string_view to_string(LoopEnd end);

struct LoopHistory {
  std::vector<LoopRow> rows;        // time rising
  std::vector<LoopImpact> impacts;  // all of them
  LoopEnd end;
  double end_time;  // s
  /// Largest relative error of fractional powers where they are made of exponentials; else 0.
  double realisation_error = 0;
};

struct LoopSimulationOptions {
  double duration = 100;            // s, > 0
  double sample_time = 0;           // s between rows; 0: rows at impacts only
  std::size_t most_impacts = 2000;  // with whole_memory the work grows as their square
  /// Of fractional powers as sums of exponentials, in [1e-12, 0.1]; relative, from one decade below to two above the
  /// frequency at which the rigid loop crosses over.
  double tolerance = 1e-8;
  /// Sums over all earlier impacts instead, exact but for rounding; for two free masses with the load measured, a
  /// controller that is a sum of powers with a dead time, restitution above 0, and without limit of the force.
  bool whole_memory = false;
  /// N, > 0: of the actuator.  Without one a derivative of order 1 that meets a step of the set-point throws mass 2 at
  /// once, by its gain times the step over the mass; with one nothing of that impulse arrives.
  double force_limit = std::numeric_limits<double>::infinity();
  bool rows_at_impacts = true;  // else samples alone
  Disturbance disturbance = {};
};

/// Motion of the loop.  Between impacts it is a sum of exponentials and a polynomial: exact for whole powers of s, and
/// for fractional ones in the tolerance.  No impact is missed: an interval is passed over only where bounds of the rate
/// exclude one.  The bodies rest in contact as long as the wall has to press; impacts that follow each other faster and
/// faster end there once they are 10^-10 as fast as the motion.  The work is proportional to the number of impacts.
///
/// With whole_memory x1 is linear in time between impacts, so that s^q x1 is a sum of (t - t_i)^(1 - q)/Gamma(2 - q)
/// over all earlier ones.  Rounding grows with the time since the start, as that to the power of 2 less the lowest
/// order of the controller.
/// @throws std::invalid_argument  dead time with x2 measured or a force on body 1; what whole_memory does not follow; a
///                                step of the set-point without a lag with powers above 1, whose force throws mass 2 at
///                                infinite speed; a start outside the clearance or not finite; a duration, sample time,
///                                tolerance, limit or number of impacts that is none, knots that do not rise from time
///                                0, or more than 10^7 rows.
[[nodiscard]] LoopHistory simulate_loop(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                                        const LoopSimulationOptions& options = {});

}  // namespace backlash
