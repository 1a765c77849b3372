// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

namespace backlash::detail {

/// Point of the motion u'' = gamma cos tau between the walls u = 0 and u = 1.
/// The phase is counted from the nearest reversal of the force, tau = half_period pi - pi/2 + s with s in [-pi/2,
/// pi/2): near a reversal, where a strong force releases the mass, s keeps its relative precision, and it never grows
/// with time. The position is the distance from a wall, so that a mass about to touch keeps relative precision at
/// either wall.
struct GapState {
  std::int64_t half_period = 0;
  double s = 0;
  double sin_s = 0;
  double cos_s = 1;
  int wall = 0;         // 0: u = distance, 1: u = 1 - distance
  double distance = 0;  // from `wall`, in [0, 1]
  double velocity = 0;  // d(distance)/d(tau), >= 0 where the distance is 0

  /// Force parity: the acceleration away from `wall` is parity() gamma sin s.
  [[nodiscard]] double parity() const noexcept { return ((half_period + wall) & 1) != 0 ? -1.0 : 1.0; }
  /// At the reversal itself the force that is about to grow counts.
  [[nodiscard]] bool is_pushed_to_wall() const noexcept {
    const double push = parity() * sin_s;
    return push < 0 || (push == 0 && parity() * cos_s < 0);
  }
  [[nodiscard]] double position() const noexcept { return wall == 0 ? distance : 1 - distance; }
  [[nodiscard]] double position_rate() const noexcept { return wall == 0 ? velocity : -velocity; }
};

/// A state at tau = 0 (force at its peak) in terms of u and u'.
[[nodiscard]] GapState state_at_peak(double position, double position_rate) noexcept;

/// Free flight up to the next contact.
struct Flight {
  bool hits = false;     // false: no contact within max_free_periods
  bool crosses = false;  // the contact is at the opposite wall
  double duration = 0;   // in radians
  double speed = 0;      // |velocity| just before the contact
  double push = 0;       // gamma parity sin s at the start: distance(h) = d + v h + push (1 - cos h) + pull (h - sin h)
  double pull = 0;       // gamma parity cos s
  // Phase at the contact as in GapState, where the search for it has found it already.
  bool has_end = false;
  std::int64_t end_half_period = 0;
  double end_s = 0;
  double end_sin = 0;
  double end_cos = 1;
};

/// Force periods without contact after which the motion counts as free of impacts.
inline constexpr std::int64_t max_free_periods = 1'000'000;

struct DistanceAndVelocity {
  double distance;
  double velocity;
};

/// How a chattering sequence of impacts is cut off.
struct ChatterTail {
  bool completes = false;  // infinitely many impacts are certain to end before the force reverses
  double duration = 0;     // from here to rest, radians
  double area = 0;         // integral of the distance over the tail
  double area_error = 0;   // bound of its error
  double loss = 0;         // energy lost in it, per unit of reduced mass: the kinetic one and the work of the force
  [[nodiscard]] bool negligible(double limit) const noexcept { return completes && area_error <= limit; }
};

/// The equation of motion; every phase of it is exact but for rounding.
class GapMotion {
 public:
  /// @param gamma        dimensionless force, positive and finite
  /// @param restitution  in [0, 1]
  GapMotion(double gamma, double restitution) noexcept
      : gamma_(gamma), restitution_(restitution), inverse_gamma_(1 / gamma) {}

  [[nodiscard]] double gamma() const noexcept { return gamma_; }
  [[nodiscard]] double restitution() const noexcept { return restitution_; }

  /// True where the mass lies on its wall and the force presses it there.
  [[nodiscard]] bool rests(const GapState& state) const noexcept {
    return state.distance <= 0 && state.velocity <= 0 && state.is_pushed_to_wall();
  }
  /// The state at which the force sets a resting mass free.
  [[nodiscard]] GapState release_after(const GapState& rest) const noexcept;
  /// The flight from a state that does not rest.  A state inside the gap may be turned to measure its distance from the
  /// other wall, so that the velocity is not negative.
  [[nodiscard]] Flight next_flight(GapState& state) const noexcept;
  /// Distance and velocity after h radians of a flight.
  [[nodiscard]] DistanceAndVelocity along(const GapState& start, const Flight& flight, double h) const noexcept;
  /// State where the force is at its peak, from distance and velocity with respect to a wall.  A contact that rounding
  /// has put just there is over.
  [[nodiscard]] GapState peak_state(int wall, const DistanceAndVelocity& at) const noexcept;
  /// State just after the impact that ends the flight.
  [[nodiscard]] GapState after_impact(const GapState& start, const Flight& flight) const noexcept;
  /// The rest of the chatter from a state on its wall, if it is certain to come to rest; none from inside the gap.
  [[nodiscard]] ChatterTail chatter_tail(const GapState& state) const noexcept;

 private:
  [[nodiscard]] Flight flight_from(GapState& state) const noexcept;
  void cross_in_one_direction(const GapState& start, double drift, Flight& flight) const noexcept;
  void fly_to_and_fro(const GapState& start, double one_minus_a, double drift, Flight& flight) const noexcept;

  double gamma_;
  double restitution_;
  double inverse_gamma_;
};

/// Advances the phase by h >= 0 and sets sin_s, cos_s.
void advance_phase(GapState& state, double h) noexcept;

/// Radians from a state to the start of a half period.
[[nodiscard]] double radians_to_half_period(const GapState& state, std::int64_t half_period) noexcept;

}  // namespace backlash::detail
