// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "backlash/rig_record.hpp"

namespace backlash {

/// What a row of a motion with compliant contacts shows.
enum class CompliantEvent {
  sample,      // at an even step of time
  contact,     // a wall begins to press
  separation,  // it presses no more, while the bodies still overlap
  parting,     // the overlap has ended
  stick1,      // body 1 comes to rest on the ground
  slide1,      // body 1, which rested, begins to move
  reversal1,   // body 1 turns without a rest
  stick2,
  slide2,
  reversal2,
};
[[nodiscard]] std::string_view to_string(CompliantEvent event);

struct CompliantRow {
  double time;           // s
  double x1;             // m
  double v1;             // m/s
  double x2;             // m
  double v2;             // m/s
  double contact_force;  // N, >= 0, between the bodies
  CompliantEvent event;
  std::optional<Wall> wall;  // that presses from there on
};

struct CompliantHistory {
  std::vector<CompliantRow> rows;  // time rising
  /// False where the motion left the range of numbers or had 10^5 events in a force period.
  bool complete;
  LoopStart end;  // at the last peak of the force
};

/// Motion under the force F cos(omega t) on body 2, evenly sampled and at every event, exact but for rounding without
/// fractional powers, else to 1e-9 of these.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, > 0
/// @param start            at t = 0, where the force is at its peak; the bodies may overlap
/// @param skip             force periods to follow before the first row, >= 0; times count from the first row
/// @param periods          of the force, > 0
/// @param samples          per period, >= 1; together at most 1e7
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; contacts as fast as
///                                bodies_describing_function() refuses.
[[nodiscard]] CompliantHistory compliant_history(const CompliantBodies& bodies, double force_amplitude, double omega,
                                                 const LoopStart& start, int skip, int periods, int samples);

/// The start of compliant_history() at which the centre of mass moves about its mean, as without friction.
/// @param start  x2 - x1 from one wall on, as simulate_impacts() counts it
[[nodiscard]] LoopStart start_about_mean(const TwoMassSystem& system, double force_amplitude, double omega,
                                         const RelativeState& start);

/// The motion under stepped_sine_force(), from frequency to frequency, and its force.
/// @param skip  periods of the first frequency to follow before the motion begins
/// @throws std::invalid_argument  as compliant_history().
[[nodiscard]] RigMotion rig_motion(const CompliantBodies& bodies, double force_amplitude,
                                   const std::vector<double>& omega, const LoopStart& start, int skip, int periods);

}  // namespace backlash
