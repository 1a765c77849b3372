// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "orbit_segment.hpp"

namespace backlash::detail {

/// The equations of one flight, see OrbitSegment, in the unknowns of its two ends.
struct FlightEquations {
  double place, velocity;                           // residuals
  double place_phase0, place_speed0, place_phase1;  // derivatives; place does not depend on speed1
  double velocity_phase0, velocity_speed0, velocity_phase1, velocity_speed1;
  double place_log_gamma, velocity_log_gamma, place_restitution, velocity_restitution;
};

[[nodiscard]] FlightEquations flight_equations(double gamma, double restitution, const SegmentImpact& from,
                                               const SegmentImpact& to);

}  // namespace backlash::detail
