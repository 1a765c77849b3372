// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/two_mass_plant.hpp"
#include "frac/fmu.hpp"

namespace backlash {

/// The two masses as a unit for co-simulation: the force on mass 2 is constant within a step, and what happens within
/// it is that of TwoMassPlant, bit for bit.  Masses, clearance, restitution and start are parameters.  No model
/// exchange: a solver would have to meet every impact of a chatter by itself.
/// @throws std::invalid_argument  the start, as TwoMassPlant; the name, as frac::fmu().
[[nodiscard]] frac::Fmu fmu(const TwoMassSystem& system, const TwoMassState& start, const frac::FmuOptions& options);

}  // namespace backlash
