// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

#include "motion/gap_motion.hpp"
#include "motion/harmonics.hpp"

namespace backlash::detail {

/// Jacobian of a map of (phase, post-impact velocity).
struct Jacobian {
  double phase_phase = 1;
  double phase_velocity = 0;
  double velocity_phase = 0;
  double velocity_velocity = 1;
  [[nodiscard]] double trace() const noexcept { return phase_phase + velocity_velocity; }
  [[nodiscard]] double determinant() const noexcept {
    return phase_phase * velocity_velocity - phase_velocity * velocity_phase;
  }
};

/// A small change of a post-impact state.
struct Displacement {
  double phase;
  double velocity;
};

/// The displacement after one flight and its impact.
[[nodiscard]] inline Displacement pushed(const Displacement& before, const GapMotion& motion, const GapState& start,
                                         const Flight& flight, const GapState& end) noexcept {
  // In the coordinate of the wall the flight starts from, with accelerations a0, a1 at its ends and impact velocity v1:
  // v1 dtau1 = (w0 + a0 h) dtau0 - h dw0 and dv1 = dw0 + a1 dtau1 - a0 dtau0; then w1 = restitution |v1|.
  const double side = flight.crosses ? 1 : -1;
  const double a0 = flight.push;
  const double a1 = -side * end.parity() * motion.gamma() * end.sin_s;
  const double h = flight.duration;
  const double phase = ((start.velocity + a0 * h) * before.phase - h * before.velocity) / (side * flight.speed);
  return {phase, side * motion.restitution() * (before.velocity + a1 * phase - a0 * before.phase)};
}

/// Derivative of one flight and its impact, from one post-impact state to the next; times `before`.
[[nodiscard]] Jacobian chain(const Jacobian& before, const GapMotion& motion, const GapState& start,
                             const Flight& flight, const GapState& end) noexcept;

/// Larger modulus of the eigenvalues.
[[nodiscard]] double spectral_radius(double trace, double determinant) noexcept;

/// An orbit that closes after `impacts` impacts and `half_periods` half periods of the force, without rests.
struct ClosedOrbit {
  GapState start;  // just after an impact
  int impacts;
  std::int64_t half_periods;
  Jacobian jacobian;
  double residual;  // |phase closure| + |velocity closure|/(1 + velocity)
  double step;      // that Newton's iteration would take next, in the same measure
};

/// Newton's iteration on the impact map from a state just after an impact.  Empty when it does not converge to
/// `tolerance`, or the order of the impacts changes on the way.
[[nodiscard]] std::optional<ClosedOrbit> close_orbit(const GapMotion& motion, const GapState& guess, int impacts,
                                                     std::int64_t half_periods, double tolerance);

/// Harmonics over the orbit.
[[nodiscard]] Harmonics orbit_harmonics(const GapMotion& motion, const ClosedOrbit& orbit);

/// The state at the first peak of the force after `start`; chatter is cut off where it is negligible at tail_limit.
[[nodiscard]] GapState state_at_next_peak(const GapMotion& motion, const GapState& start, double tail_limit);

}  // namespace backlash::detail
