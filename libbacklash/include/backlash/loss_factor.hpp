// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>

#include "backlash/two_mass_system.hpp"

namespace backlash {

/// Loss factor of the two masses, seen at mass 1, which is not forced: Im(-1/N1)/((M1 + M2) omega^2), no unit.
/// (M1 + M2) omega^2 is -1/N1 of the masses locked together, so that this is the lost part of -1/N1 over that.  By the
/// balance of energy over a closed orbit with n impacts per period, of speeds v_k before the impacts and phases phi_k
/// of the force, the sign by the wall,
///   Im(-1/N1)/((M1 + M2) omega^2) = (pi/2) (1-e)/(1+e) sum v_k^2/|sum (+-) v_k e^(-j phi_k)|^2,
/// nothing else of the motion enters.  It is a function of frequency_ratio() and restitution alone.  The law holds for
/// bodies without springs, friction and the like.
/// @param minus_inverse_n1  -1/N of x1, N/m
/// @param omega             rad/s, > 0
[[nodiscard]] double loss_factor(const TwoMassSystem& system, std::complex<double> minus_inverse_n1, double omega);

/// omega/sqrt(F/(M2 clearance)), no unit; 0 without clearance.
/// @param force_amplitude  N, > 0
[[nodiscard]] double frequency_ratio(const TwoMassSystem& system, double force_amplitude, double omega);

/// Loss factor of the orbits with two impacts per period of equal speed, half a period apart: (pi/4) (1-e)/(1+e),
/// whatever force, clearance and masses.  So Im(-1/N1) rises with omega^2 there, exactly.
/// @param restitution  0 to 1
/// @throws std::invalid_argument
[[nodiscard]] double symmetric_loss_factor(double restitution);

/// Least loss factor of a closed orbit with so many impacts per force period, by Cauchy and Schwarz:
/// (pi/(2 n)) (1-e)/(1+e), met where their speeds are equal and those at one wall in antiphase to those at the other.
/// @param impacts_per_period  > 0; a fraction for orbits of several periods; 0 where infinite
/// @throws std::invalid_argument
[[nodiscard]] double least_loss_factor(double restitution, double impacts_per_period);

/// The restitution at which symmetric_loss_factor() is this, (1-q)/(1+q) with q = 4 loss_factor/pi: what one point of a
/// curve tells, without any fit.  Empty where there is none: below 0, or above pi/4, that of restitution 0.
[[nodiscard]] std::optional<double> restitution_from_loss_factor(double loss_factor);

}  // namespace backlash
