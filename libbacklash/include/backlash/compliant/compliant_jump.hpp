// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant_contact.hpp"
#include "backlash/jump_frequency.hpp"

namespace backlash {

/// Lambda = k clearance M2/(m F), m the reduced mass: the stiffness of a contact beside the force.  With the damping
/// ratio it is all that the motions over omega/sqrt(F/(M2 clearance)) depend on.
/// @param mass1,mass2  kg, > 0;  @param clearance  m, > 0;  @param force_amplitude  N, > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
[[nodiscard]] double stiffness_group(const CompliantContact& contact, double mass1, double mass2, double clearance,
                                     double force_amplitude);

/// A jump of masses whose contacts take time: omega_jump = c sqrt(F/(M2 clearance)), where c depends on Lambda and,
/// with dry friction, on its share of the force.
struct CompliantJump : JumpFrequency {
  double stiffness_group;
  /// omega_jump ~ F^exponent clearance^clearance_exponent near these, 1/2 and -1/2 with contacts that take no time and
  /// no friction: b = 1/2 - d ln c/d ln Lambda and -b without friction.  From central differences; NaN where there is
  /// no jump, or none was asked for.
  double exponent;
  double clearance_exponent;
};

/// Ends of the stable symmetric orbit of two contacts a period: symmetry_loss is the low-frequency one, saddle_node the
/// high-frequency one.  The orbit is followed in its closed form, from that of a restitution, until it attracts no more
/// or meets a wall once more.
/// @param stiffness_group  > 0
/// @param damping_ratio    > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; of the criteria another.
[[nodiscard]] CompliantJump compliant_jump(double stiffness_group, double damping_ratio, JumpCriterion criterion,
                                           bool with_exponents = true);
/// The same of masses, which dry friction may act on: the orbit is then followed on the flow, which takes some tenths
/// of a second, and five times as long with exponents.
/// @param force_amplitude  N, > 0
/// @throws std::invalid_argument  as above; bodies with springs or viscous friction.
[[nodiscard]] CompliantJump compliant_jump(const CompliantBodies& bodies, double force_amplitude,
                                           JumpCriterion criterion, bool with_exponents = true);

}  // namespace backlash
