// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
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

/// What x1 should be: step + ramp t from t = 0 on, m and m/s.  The controller gets the difference, derivatives too.
struct SetPoint {
  double step = 0;
  double ramp = 0;
};

enum class LoopEvent { sample, before_impact, after_impact };
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
  rest,          // the masses stay in contact, or impacts follow each other without end
  most_impacts,  // as many as were allowed
};
[[nodiscard]] std::string_view to_string(LoopEnd end);

struct LoopHistory {
  std::vector<LoopRow> rows;        // time rising
  std::vector<LoopImpact> impacts;  // all of them
  LoopEnd end;
  double end_time;  // s
};

struct LoopSimulationOptions {
  double duration = 100;            // s, > 0
  double sample_time = 0;           // s between rows; 0: rows at impacts only
  std::size_t most_impacts = 2000;  // the work grows as their square
};

/// Motion of the loop with the whole memory of the controller, exact but for rounding: between impacts x1 is linear in
/// time, so that s^q x1 is a sum of (t - t_i)^(1 - q)/Gamma(2 - q) over all earlier impacts.  No impact is missed:
/// steps are taken where bounds of the velocity, a sum of monotone powers, exclude a wall or a second crossing.
/// Rounding grows with the time since the start, as that to the power of 2 less the lowest order of the controller.
/// @throws std::invalid_argument  bodies that are no free masses; restitution 0; x2 measured, or a controller that is
/// no sum of powers of s with a dead time; a step of
///                                the set-point with powers above 1, whose force throws mass 2 at infinite speed; a
///                                start outside the clearance or not finite; a duration, sample time or number of
///                                impacts that is none, or more than 10^7 rows.
[[nodiscard]] LoopHistory simulate_loop(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                                        const LoopSimulationOptions& options = {});

}  // namespace backlash
