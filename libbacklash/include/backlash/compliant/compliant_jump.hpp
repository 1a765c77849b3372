// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/compliant_contact.hpp"
#include "backlash/jump_frequency.hpp"

namespace backlash {

/// Lambda = k clearance M2/(m F), m the reduced mass: the stiffness of a contact beside the force.  With the damping
/// ratio it is all that the motions over omega/sqrt(F/(M2 clearance)) depend on.
/// @param mass1,mass2  kg, > 0;  @param clearance  m, > 0;  @param force_amplitude  N, > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
[[nodiscard]] double stiffness_group(const CompliantContact& contact, double mass1, double mass2, double clearance,
                                     double force_amplitude);

/// A jump of free masses whose contacts take time: omega_jump = c sqrt(F/(M2 clearance)), where c depends on Lambda.
struct CompliantJump : JumpFrequency {
  double stiffness_group;
  /// b = 1/2 - d ln c/d ln Lambda: omega_jump ~ F^b clearance^-b near these, 1/2 with contacts that take no time.  From
  /// a central difference; NaN where there is no jump.
  double exponent;
};

/// Ends of the stable symmetric orbit of two contacts a period: symmetry_loss is the low-frequency one, saddle_node the
/// high-frequency one.  The orbit is followed in its closed form, from that of a restitution, until it attracts no more
/// or meets a wall once more.
/// @param stiffness_group  > 0
/// @param damping_ratio    > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; of the criteria another.
[[nodiscard]] CompliantJump compliant_jump(double stiffness_group, double damping_ratio, JumpCriterion criterion);

}  // namespace backlash
