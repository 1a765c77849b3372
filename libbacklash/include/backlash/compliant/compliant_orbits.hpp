// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/orbit_continuation.hpp"

namespace backlash {

/// The periodic orbits of bodies with compliant contacts between two values of omega, force, clearance or
/// contact_frequency: those that motions from starts spread over the range settle on and those that the symmetric
/// orbits of the restitution become, continued through folds by pseudo-arclength on the flow, and those that branch off
/// them at symmetry breaking and period doubling.  With damping the flow has a kink where a contact of speed 0 is
/// gained or lost, and so it has where a rest of a body with dry friction is: there a branch ends (BranchEnd::grazing,
/// sticking), and the orbits beyond are a branch that begins there, on the other side or, where the kink is a fold, on
/// the same; its multipliers are those of its side.  Orbits of contacts that last are among them, as nothing rests.
/// Multipliers are the two of largest modulus of all states that an orbit repeats; an impact is a contact, its speed
/// that at its start, which is 0 where overlapping bodies press anew.  Orbits are exact as those of
/// bodies_describing_function(); bifurcations are refined to 1e-9 of the parameter.  Not promised: every orbit, as for
/// contacts that take no time.
/// @param parameter  not restitution
/// @return `system` has the restitution of a free contact
/// @throws std::invalid_argument  as orbit_diagram() of two masses; contacts that bodies_describing_function() refuses.
[[nodiscard]] OrbitDiagram orbit_diagram(const CompliantBodies& bodies, double force_amplitude, double omega,
                                         OrbitParameter parameter, double from, double to,
                                         const OrbitContinuationOptions& options = {},
                                         frac::Progress* progress = nullptr);

}  // namespace backlash
