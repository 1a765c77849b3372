// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <vector>

namespace frac {

/// Mittag-Leffler function E_{alpha,beta}(z) = sum_k z^k / Gamma(alpha k + beta)  (Gorenflo, Kilbas, Mainardi, Rogosin
/// 2014, eq. 4.1.1): exp(z) at (1, 1), cosh(sqrt(z)) at (2, 1), exp(z^2) erfc(-z) at (1/2, 1).
///
/// Error for beta <= 10: 1e-14 (1 + |E|) max(1, |z E'/E|); for z < 0, 0 < alpha <= 0.99 and beta >= alpha also 1e-13
/// |E|, the zeros of E apart.  Infinite on overflow alone, never NaN.
/// Evaluation: inverse Laplace transform along a vertical line in w, s = w^2, where the trapezoidal rule converges
/// geometrically and each pole s^alpha = z is taken out in closed form, so that no z is near a boundary between
/// formulas (Trefethen, Weideman 2014, section 5; Garrappa 2015 for the poles); for beta < -1 in long double, some
/// twenty times slower.
/// @throws std::invalid_argument  alpha not in (0, 100], |beta| > 50, or an argument not finite.
[[nodiscard]] double mittag_leffler(double alpha, double beta, double z);
[[nodiscard]] std::complex<double> mittag_leffler(double alpha, double beta, std::complex<double> z);

/// The same at many points; for z < 0 and alpha < 1 one fixed rational function serves all of them.
/// @throws std::invalid_argument  as above, with the index of an entry not finite; lengths differ.
[[nodiscard]] std::vector<double> mittag_leffler(double alpha, double beta, std::span<const double> z);
[[nodiscard]] std::vector<std::complex<double>> mittag_leffler(double alpha, double beta,
                                                               std::span<const std::complex<double>> z);
void mittag_leffler(double alpha, double beta, std::span<const double> z, std::span<double> value);

/// d/dz E_{alpha,beta}(z).  Error 1e-13 (1 + |E'|) max(1, |z E''/E'|) for beta <= 10.
/// @throws std::invalid_argument  as mittag_leffler().
[[nodiscard]] double mittag_leffler_derivative(double alpha, double beta, double z);
[[nodiscard]] std::complex<double> mittag_leffler_derivative(double alpha, double beta, std::complex<double> z);

/// Three-parameter function E^gamma_{alpha,beta}(z) = sum_k (gamma)_k z^k / (k! Gamma(alpha k + beta))  (Prabhakar
/// 1971), inverse Laplace transform of s^(alpha gamma - beta) / (s^alpha - z)^gamma at time 1.
/// Error 1e-12 (1 + |E|) max(1, |z E'/E|) for 0.1 <= alpha <= 2, |beta| <= 10, 0 < gamma <= 10.
/// @throws std::invalid_argument  as above, alpha > 2, gamma not in (0, 100], or gamma neither 1 nor 2 with a root of
///                                s^alpha = z on the principal sheet beyond |s| = 1000.
[[nodiscard]] double prabhakar(double alpha, double beta, double gamma, double z);
[[nodiscard]] std::complex<double> prabhakar(double alpha, double beta, double gamma, std::complex<double> z);

}  // namespace frac
