// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "backlash/loops/linear_bodies.hpp"

namespace backlash::detail {

struct ImpulseAnswer;

/// The symmetric orbits with two impacts per period, at opposite walls, of linear bodies under a sine force on body 2.
/// With impulses +-I, the first of them on body 1 at x2 - x1 = +clearance/2 at t = 0, and the force Re F e^{jwt},
///   Re(F G2) = clearance/2 + I sum (-1)^l g(l tau),   -w Im(F G2) = I [h1/(1 + eps) + sum (-1)^l g'(l tau)],
/// l >= 1: position and speed at the impact.  Given |F| that is a quadratic for I.
class ForcedOrbits {
 public:
  /// @param response  of the bodies alone
  ForcedOrbits(const LinearBodies& bodies, const ImpulseAnswer& response, double omega);
  ForcedOrbits(const LinearBodies& bodies, double omega);

  /// Phasors of the fundamentals.
  struct Orbit {
    double impulse;
    std::complex<double> force;
    std::complex<double> x1;
    std::complex<double> x2;
  };
  [[nodiscard]] Orbit of_impulse(double impulse) const;
  /// Of the two orbits that a force has, that of the faster impacts or the other; where there is none, the one of the
  /// least force.  Its impulse may be negative: no motion.
  [[nodiscard]] Orbit at(double force, bool is_faster) const;
  /// |F| below which there is no orbit.
  [[nodiscard]] double least_force() const;

  /// Peak of the fundamental of alternating unit impulses: 2 w/pi.
  [[nodiscard]] static double impulse_share(double omega);

 private:
  double omega_;
  double half_clearance_;
  std::complex<double> load_;  // receptances at j omega
  std::complex<double> drive_;
  double position_;  // Re(F G2) less clearance/2, per impulse
  double lag_;       // Im(F G2) per impulse
  double lowest_;    // impulse at the least force
};

}  // namespace backlash::detail
