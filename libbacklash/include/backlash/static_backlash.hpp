#pragma once

#include <complex>
#include <vector>

namespace backlash {

/// Describing function N_b(X) of the static backlash (play) with slope `gain` and dead zone `clearance` (m) at input amplitude X
/// (m); 0 for X <= clearance/2.  Duarte, Tenreiro Machado (2009), eq. (1) with the argument corrected:
///   Re = (k/pi)[pi/2 + asin u + u sqrt(1 - u^2)],  Im = -2 k clearance (X - clearance/2)/(pi X^2),  u = 1 - clearance/X.
/// @throws std::invalid_argument  gain not positive, clearance negative, amplitude not positive.
[[nodiscard]] std::complex<double> static_backlash(double gain, double clearance, double amplitude);

/// Which mass stands in front of the backlash and sets the amplitude X = F/(M omega^2).
enum class FrontMass { both, forced };

/// The static model as a describing function of the two masses: N = -N_b(X)/((M1 + M2) omega^2) with unit gain.
[[nodiscard]] std::vector<std::complex<double>> static_describing_function(double mass1, double mass2, double clearance,
                                                                           double force_amplitude,
                                                                           const std::vector<double>& omega,
                                                                           FrontMass front = FrontMass::both);

}  // namespace backlash
