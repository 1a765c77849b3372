// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "backlash/impact_simulation.hpp"
#include "backlash/two_mass_system.hpp"

namespace backlash {

/// What a row of a time history shows.
enum class HistoryEvent {
  sample,         // at an even step of time
  before_impact,  // exact in time; the velocities before
  after_impact,   // the same time, the velocities after
  rest_begin,     // the masses begin to move as one, after infinitely many impacts or one without rebound
  release,        // the force draws them apart again
};
[[nodiscard]] std::string_view to_string(HistoryEvent event);

/// Motion of both masses, in the frame in which their centre of mass swings about 0: -F/((M1 + M2) omega^2) cos(omega
/// t).
struct HistoryRow {
  double time;  // s since the start, where the force is at its peak
  double x1;    // m
  double v1;    // m/s
  double x2;    // m
  double v2;    // m/s
  HistoryEvent event;
  std::optional<Wall> wall;  // in contact there
};

struct TimeHistory {
  std::vector<HistoryRow> rows;  // time rising
  bool complete;                 // false where max_impacts ended it early
  RelativeState end;             // where the force is at its peak, or at the last impact allowed
};

/// Positions and velocities of both masses, evenly sampled and at every impact, both exact but for rounding.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, > 0; F/(M2 clearance omega^2) in (0, 1e30)
/// @param start            at t = 0
/// @param periods          of the force, > 0
/// @param samples          per period, >= 1; together at most 1e7
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; clearance 0 has no impacts.
[[nodiscard]] TimeHistory time_history(const TwoMassSystem& system, double force_amplitude, double omega,
                                       const RelativeState& start, int periods, int samples,
                                       std::size_t max_impacts = 1'000'000);

/// The same under one frequency after the other, as a stepped sine drives a rig: the force F cos(phase) changes its
/// frequency at its peak, after so many periods of each, without a jump.  Times count from the first peak; the frame is
/// that of the first frequency, in which all positions and velocities are continuous but for impacts.
/// @param omega  rad/s, each as in time_history(); not empty
/// @throws std::invalid_argument  as time_history(), and above 1e7 samples in all.
[[nodiscard]] TimeHistory stepped_sine_history(const TwoMassSystem& system, double force_amplitude,
                                               const std::vector<double>& omega, const RelativeState& start,
                                               int periods, int samples);

}  // namespace backlash
