// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "backlash/describing_function.hpp"
#include "motion/gap_motion.hpp"

namespace backlash::detail {

/// h = 1 + U/gamma of a steady relative motion, U the phasor of u = y/clearance, with its derivatives; of a harmonic k
/// above the first h = U_k/gamma.
struct GapResponse {
  std::complex<double> h;
  std::complex<double> by_log_gamma;
  std::complex<double> by_restitution;
  std::complex<double> by_contact;  // omega times the time of a free contact; 0 where contacts are hard
};

/// The orbit of two impacts per period, symmetric up to symmetry_breaking_gamma and asymmetric above, whether stable or
/// not, in closed form.  Empty below the saddle-node, or where no member of the asymmetric family has this gamma.
/// @param restitution  in [0, 1]
/// @param harmonic     odd
[[nodiscard]] std::optional<GapResponse> two_impact_response(double gamma, double restitution, int harmonic = 1);

/// h of the motion that sticks every period after release from contact, mostly after chatter: it has forgotten its
/// past, so there is only one.  Empty where the motion from contact at rest becomes another one.
/// @param harmonic  1, 3 or 5
[[nodiscard]] std::optional<std::complex<double>> sticking_h(double gamma, double restitution, int harmonic = 1);
/// Of the harmonics 1, 3 and 5.
[[nodiscard]] std::optional<std::array<std::complex<double>, 3>> sticking_harmonics(double gamma, double restitution);
/// With derivatives by differences, to five digits; empty also where a neighbour they need does not stick.
[[nodiscard]] std::optional<GapResponse> sticking_response(double gamma, double restitution, int harmonic = 1);

/// A motion that some start leads to.
struct StartedMotion {
  std::complex<double> h;
  bool closes;  // an orbit, not a long mean
};
/// The different motions that a dozen starts over the gap settle on, one of them contact at rest.  An orbit that few
/// starts lead to may be missed.
[[nodiscard]] std::vector<StartedMotion> motions_of_starts(double gamma, double restitution);

/// Contact at rest, the force at its peak: leads to the chattering motion where there is one.
[[nodiscard]] GapState contact_at_rest_state();

}  // namespace backlash::detail
