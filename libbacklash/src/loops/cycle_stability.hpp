// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/loops/limit_cycles.hpp"
#include "gap_response.hpp"

namespace backlash::detail {

/// Multipliers of the half-period map of a symmetric cycle: the roots but z = 1 of
///   D(z) = (q + G1(z))^2 - G0(z) (G2(z) - G2(1)),   Gj = sum_(l >= 1) (-1)^l g^(j)(l tau) z^-l,
/// which says that a disturbance of instants and impulses that grows by z per half period meets wall and restitution.
/// Those outside the unit circle are counted by the argument principle.
/// @param exchange  q = (1/M1 + 1/M2)/(1 + restitution)
[[nodiscard]] CycleStability cycle_stability(const ImpulseTrain& train, double exchange);

/// Of a symmetric orbit under a force of fixed phase, which knows no shift in time: the roots of
///   (q + G1(z))^2 - G0(z) (G2(z) - acceleration).
/// @param acceleration  (x2 - x1)'' just before the impact at +clearance/2, over minus the impulse
[[nodiscard]] CycleStability forced_stability(const ImpulseTrain& train, double exchange, double acceleration);

}  // namespace backlash::detail
