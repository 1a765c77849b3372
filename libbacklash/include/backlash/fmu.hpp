// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/two_mass_plant.hpp"
#include "frac/fmu.hpp"

namespace backlash {

/// The two masses as a unit.  Co-simulation: the force on mass 2 is constant within a step, and what happens within it
/// is that of TwoMassPlant, bit for bit.  Model exchange: the states are the centre of mass, the gap and their rates;
/// the indicators are the distances from both walls and whether a contact is released.  The simulator meets each
/// impact; hops below 1e-9 of the clearance end in contact.  Masses, clearance, restitution and start are parameters.
/// @throws std::invalid_argument  the start, as TwoMassPlant; the name, as frac::fmu().
[[nodiscard]] frac::Fmu fmu(const TwoMassSystem& system, const TwoMassState& start, const frac::FmuOptions& options);

}  // namespace backlash
