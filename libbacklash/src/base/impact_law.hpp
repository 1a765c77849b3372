// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/two_mass_system.hpp"

namespace backlash::detail {

// The law of impact, which post_impact_velocities() applies, in terms of the impulse.  Bodies that meet at relative
// velocity v part at -restitution v (Newton), and an impulse I on mass 1 with its opposite on mass 2 turns the relative
// velocity by h1 I, h1 = 1/M1 + 1/M2:
//   (1 + restitution) v = h1 I.

/// I/v, kg.
[[nodiscard]] inline double impulse_per_speed(const TwoMassSystem& system) noexcept {
  return (1 + system.restitution()) / (1 / system.mass1() + 1 / system.mass2());
}

/// v/I, 1/kg.
/// @param jump  h1, 1/kg
[[nodiscard]] inline double speed_per_impulse(double jump, const TwoMassSystem& system) noexcept {
  return jump / (1 + system.restitution());
}

/// Mean of the relative velocities before and after an impact over half their difference: 0 where nothing is lost, 1
/// where the bodies stay together.
[[nodiscard]] inline double loss_ratio(double restitution) noexcept {
  return (1 - restitution) / (1 + restitution);
}

}  // namespace backlash::detail
