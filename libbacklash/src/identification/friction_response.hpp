// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <optional>

#include "compliant/compliant_orbit.hpp"

namespace backlash::detail {

/// Free masses whose contacts take time and which rub on the ground, in groups.
struct FrictionGroups {
  double gamma;                    // F/(mass2 clearance omega^2)
  double tau;                      // omega times the time of a free contact, >= 0; 0 of hard contacts
  double restitution;              // of a free contact, as contact_shape()
  double mass_ratio;               // mass1/mass2
  std::array<double, 2> friction;  // dry friction on each over the force amplitude, >= 0
};

/// n = m omega^2 N, m the reduced mass, of an orbit of one period, with its derivatives.
struct FrictionResponse {
  std::complex<double> n;
  std::complex<double> by_log_gamma, by_tau, by_restitution, by_log_mass_ratio;
  std::array<std::complex<double>, 2> by_friction;
};

/// What was found last of one point, from which Newton's method finds the orbit of a scene nearby.
using FoundOrbit = std::optional<CompliantOrbit>;

/// Where the motion is followed from, to an orbit of one period that attracts.
enum class FrictionStart {
  found,      // the orbit found last
  symmetric,  // the orbit of two symmetric contacts without friction
  rest,       // contact at rest
};

/// Empty where there is no stable orbit of one period with contacts to be found from there.
/// Of hard contacts extrapolated from two that take nearly no time: off by the square of their angle, 1e-6.
/// Without friction the load has a millionth of the force, which keeps the bodies from drifting and moves n by about as
/// much.
/// @param output    of which body
/// @param harmonic  from 1 on
[[nodiscard]] std::optional<std::complex<double>> friction_n(const FrictionGroups& groups, Output output,
                                                             FrictionStart start, FoundOrbit& found, int harmonic = 1);
/// With derivatives: that of the orbit by the flow's own, what parameters change over a period by differences.
[[nodiscard]] std::optional<FrictionResponse> friction_response(const FrictionGroups& groups, Output output,
                                                                const FoundOrbit& found, int harmonic = 1);

}  // namespace backlash::detail
