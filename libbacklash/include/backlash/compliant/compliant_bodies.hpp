// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/compliant_contact.hpp"
#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "backlash/sweep_pieces.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// Coulomb friction between each body and the ground, N, >= 0: Fc against the velocity, and at rest whatever holds the
/// body, up to Fc.
struct CoulombFriction {
  double body1 = 0;
  double body2 = 0;
};

/// Two bodies with clearance whose contact has a stiffness and a damping, and dry friction on each.
class CompliantBodies {
 public:
  /// @param load,drive  receptances as those of LinearBodies, without dry friction; free_mass() of a free one
  /// @param clearance   m, > 0
  /// @throws std::invalid_argument  as LinearBodies; a friction that is negative or not finite.
  CompliantBodies(frac::FractionalTransferFunction load, frac::FractionalTransferFunction drive, double clearance,
                  const CompliantContact& contact, const CoulombFriction& friction = {});

  /// Receptances, clearance and masses, with the restitution of a free contact in place of stiffness and damping: the
  /// bodies whose contacts take no time, to which these tend as the stiffness grows at one damping ratio.
  [[nodiscard]] const LinearBodies& hard() const noexcept { return hard_; }
  [[nodiscard]] const TwoMassSystem& system() const noexcept { return hard_.system(); }
  [[nodiscard]] const CompliantContact& contact() const noexcept { return contact_; }
  [[nodiscard]] const CoulombFriction& friction() const noexcept { return friction_; }
  /// Nothing but the contact and the force acts on either.
  [[nodiscard]] bool are_free() const noexcept {
    return hard_.are_free() && friction_.body1 == 0 && friction_.body2 == 0;
  }

 private:
  CompliantContact contact_;
  CoulombFriction friction_;
  LinearBodies hard_;
};

/// N(F, omega) of bodies with compliant contacts: position phasor over that of the sine force on body 2.  The motion is
/// followed from event to event (contacts begin and end, bodies stick and slip), each flight by its exponentials; one
/// that closes after at most 32 force periods is solved by Newton's method on the flow, its derivative being the
/// product of the flights' and of the jumps at events; the rest is a mean with its 95 % half width.  Exact but for
/// rounding without fractional powers, else to 1e-9 of these.
/// Protocol::two_impact takes of free bodies the symmetric orbit of two contacts where it attracts, in closed form but
/// for three unknowns; else it tries the orbit of one period nearest to the state carried, then to that of hard
/// contacts. Regime::symmetric is an orbit of one period whose halves mirror each other, whatever its contacts;
/// impacts_per_period counts contacts; energy_defect is the work of the force less what contacts and friction take,
/// over the energy that the force gives and takes back.  A phasor is that of the velocity over j omega, so that a body
/// may drift. `options.tolerance` is not used: closed orbits are solved to rounding.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, positive, strictly rising, not empty
/// @return `system` has the restitution of a free contact
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed; contacts more than 10^6
/// times
///                                as fast as the force, or with c/m above 10^9 times.
[[nodiscard]] DescribingFunctionSweep bodies_describing_function(const CompliantBodies& bodies, double force_amplitude,
                                                                 const std::vector<double>& omega,
                                                                 const SweepOptions& options);

/// One curve of a family.
struct CompliantScene {
  CompliantBodies bodies;
  double force_amplitude;  // N
};

/// A family of curves over one grid, computed in parallel; the result does not depend on options.threads.
/// @param progress  counts points, if given
/// @throws std::invalid_argument  as above; of several scenes the text names the one.
[[nodiscard]] std::vector<DescribingFunctionSweep> bodies_describing_functions(
    const std::vector<CompliantScene>& scenes, const std::vector<double>& omega, const SweepOptions& options,
    frac::Progress* progress = nullptr);
/// The same piece by piece.
[[nodiscard]] SweepPieces bodies_sweep_pieces(std::vector<CompliantScene> scenes, std::vector<double> omega,
                                              const SweepOptions& options);

}  // namespace backlash
