// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "backlash/impact_simulation.hpp"
#include "backlash/two_mass_system.hpp"
#include "frac/records/sensor.hpp"

namespace backlash {

/// A force and the positions that it makes, over time: N and m.
struct RigMotion {
  frac::SignalPath force, x1, x2;
  bool complete = true;             // false where the motion could not be followed to its end
  frac::SignalPath set_point = {};  // m, of a loop that it drives; else empty
};

/// How a rig reads its signals.
struct RigSensors {
  double sample_time = 0;       // s, > 0
  double clock_jitter = 0;      // standard deviation of each instant, s, 0 to a tenth of the sample time
  frac::SensorErrors position;  // of both positions, m
  frac::SensorErrors force;     // N
  std::uint64_t seed = 1;       // of noise and jitter
};

/// Readings at equal steps of time, as the clock gives it.
struct RigRecord {
  std::vector<double> time, force, x1, x2;
  std::vector<double> set_point = {};  // as it is; empty where the motion has none
};

/// F cos(phase), so many periods of each frequency, which changes at a peak; times count from the first peak.
/// @param steps  entries per period
[[nodiscard]] frac::SignalPath stepped_sine_force(double force_amplitude, const std::vector<double>& omega, int periods,
                                                  int steps);

/// Entries per period of the motions that records sample: the cubic between them errs by (2 pi/200)^4/384 = 2.5e-9 of a
/// sine.
constexpr int rig_steps = 200;

/// The motion of stepped_sine_history() and its force.
/// @throws std::invalid_argument  as stepped_sine_history().
[[nodiscard]] RigMotion rig_motion(const TwoMassSystem& system, double force_amplitude,
                                   const std::vector<double>& omega, const RelativeState& start, int periods);

/// What a rig writes down of a motion, from the first sample at which every reading, late as it is, lies within the
/// motion, to the last.
/// @throws std::invalid_argument  a number out of its range, or not 1 to 1e7 samples; the text names it.
[[nodiscard]] RigRecord rig_record(const RigMotion& motion, const RigSensors& sensors);

}  // namespace backlash
