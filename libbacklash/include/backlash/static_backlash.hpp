// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

namespace backlash {

/// Describing function N_b(X) of the static backlash (play) with slope `gain` and play `clearance` (m) at input
/// amplitude X (m); 0 for X <= clearance/2.  Duarte, Tenreiro Machado (2009), eq. (1) with the argument corrected:
///   Re = (k/pi)[pi/2 + asin u + u sqrt(1 - u^2)],  Im = -2 k clearance (X - clearance/2)/(pi X^2),  u = 1 -
///   clearance/X.
/// @throws std::invalid_argument  gain not positive, clearance negative, amplitude not positive, or one of them not
/// finite.
[[nodiscard]] std::complex<double> static_backlash(double gain, double clearance, double amplitude);

/// The static model as a describing function of the two masses, m/N: N = -N_b(X)/((M1 + M2) omega^2) with unit gain and
/// the amplitude X = F/((M1 + M2) omega^2) of the masses moving as one.
/// @param omega  rad/s, positive, strictly increasing, not empty
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
[[nodiscard]] std::vector<std::complex<double>> static_describing_function(double mass1, double mass2, double clearance,
                                                                           double force_amplitude,
                                                                           const std::vector<double>& omega);

}  // namespace backlash
