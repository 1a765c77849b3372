// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <optional>

namespace backlash::detail {

/// Free bodies whose contacts take time, in units of clearance and angle of the force:
///   u'' = gamma cos(tau) - s [nu^2 delta + 2 zeta nu delta']+,  delta = s u - 1/2 > 0 at the wall s = 1, -1.
struct CompliantGroups {
  double gamma;  // F/(M2 clearance omega^2)
  double nu;     // contact frequency over omega
  double zeta;   // damping ratio
};

/// The orbit of two contacts half a period apart, each of one piece, and mirror images of each other.  Both the flight
/// in contact, a damped oscillator under a cosine, and the free one are closed forms, so that the orbit is a root of
/// three equations in the angle and speed at which a wall is met and the angle spent in contact.
struct SymmetricCompliantOrbit {
  double angle;     // of the force where the wall u = 1/2 is met
  double speed;     // du/dtau there
  double duration;  // angle until the wall presses no more
  /// (2/pi) times the integral of the contact's acceleration times e^{-j k tau}, k = 1, 3 and 5, over one contact.
  std::array<std::complex<double>, 3> contact;
  double largest_multiplier;  // of the map over a period
  double residual;            // of the equations, in clearances
  double loss;                // of both contacts, per reduced mass, clearance^2 and omega^2
};

/// By Newton's method from a guess.  Empty where it does not converge, or where the orbit is not simply seen to press
/// throughout its contacts and to meet nothing in between.
[[nodiscard]] std::optional<SymmetricCompliantOrbit> symmetric_compliant_orbit(const CompliantGroups& groups,
                                                                               double angle, double speed,
                                                                               double duration);
/// From the orbit of contacts that take no time and have the restitution of these: contacts nearly as hard, made softer
/// by halves.  Empty where there is no such orbit, or the way is lost.
[[nodiscard]] std::optional<SymmetricCompliantOrbit> symmetric_compliant_orbit_from_hard(const CompliantGroups& groups);

}  // namespace backlash::detail
