// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/loops/limit_cycles.hpp"
#include "gap_response.hpp"

namespace backlash::detail {

/// Multipliers of the half-period map of a symmetric cycle: the roots but z = 1 of
///   D(z) = (q + G1(z))^2 - G0(z) (G2(z) - G2(1)),   Gj = sum_(l >= 1) (-1)^l g^(j)(l tau) z^-l,
/// which says that a disturbance of instants and impulses that grows by z per half period meets wall and restitution.
/// Multipliers outside the unit circle are counted by the argument principle.
/// @param exchange  q = (1/M1 + 1/M2)/(1 + restitution)
[[nodiscard]] CycleStability cycle_stability(const ImpulseTrain& train, double exchange);

/// Stability of a symmetric orbit under a force of fixed phase, which knows no shift in time: the roots of
///   (q + G1(z))^2 - G0(z) (G2(z) - acceleration).
/// @param acceleration  (x2 - x1)'' just before the impact at +clearance/2, over minus the impulse
[[nodiscard]] CycleStability forced_stability(const ImpulseTrain& train, double exchange, double acceleration);
/// Whether it is stable, by the count alone.
[[nodiscard]] bool is_forced_stable(const ImpulseTrain& train, double exchange, double acceleration);

/// Of a motion with any impacts per period: multipliers per period but that of a shift in time, the roots of det D(z)
/// for disturbances of instants, delta_a, and impulses, iota_a, that grow by z per period,
///   -sum_b G0_ab iota_b + sum_b G1_ab I_b delta_b + q I_a delta_a = 0              (the wall is met)
///   -sum_b G1_ab iota_b + sum_b G2_ab I_b delta_b + y''_a delta_a - q iota_a = 0   (restitution),
/// Gj_ab the sum over the earlier impacts b of g^(j) at their lags times z to minus the periods between.
/// @param train  of `response` over the period
/// @param times  of the impacts, s, rising from 0, below the period
/// @param bend   (x2 - x1)'' just before each, over minus its impulse
/// @param is_forced  under a force of fixed phase, which knows no shift in time
[[nodiscard]] CycleStability cycle_stability(const ImpulseAnswer& response, const ImpulseTrain& train,
                                             const std::vector<double>& times, const std::vector<double>& bend,
                                             double exchange, bool is_forced = false);

}  // namespace backlash::detail
