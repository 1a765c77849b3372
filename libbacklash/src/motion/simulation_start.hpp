// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/impact_simulation.hpp"
#include "backlash/two_mass_system.hpp"
#include "gap_motion.hpp"

namespace backlash::detail {

/// The part of the integral of u that is neglected where a chatter is cut off.
inline constexpr double neglected_tail = 1e-13;

/// The scene of a simulation in dimensionless form.
struct SimulationStart {
  GapMotion motion;
  GapState state;
  double speed_unit;  // m/s per unit of du/d(omega t)
};

/// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
[[nodiscard]] SimulationStart simulation_start(const TwoMassSystem& system, double force_amplitude, double omega,
                                               const RelativeState& start, int periods);

[[nodiscard]] inline Wall wall_of(const GapState& state) noexcept {
  return state.wall == 0 ? Wall::near : Wall::far;
}

}  // namespace backlash::detail
