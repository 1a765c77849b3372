// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include "gap_motion.hpp"

namespace backlash::detail {

/// Orders k of the harmonics kept; the second one, last, shows a broken symmetry.
inline constexpr std::array<int, 4> harmonic_orders = {1, 3, 5, 2};
inline constexpr std::size_t second_harmonic = 3;  // its index
using HarmonicSums = std::array<std::complex<double>, harmonic_orders.size()>;

/// Phasors U_k of u(tau) = Re sum U_k e^{j k tau}.
struct Harmonics {
  HarmonicSums u{};
  std::complex<double> u1_plus_gamma;  // U_1 + gamma, free of cancellation where the motion is nearly free
};

/// j^k z, exactly.
[[nodiscard]] std::complex<double> quarter_turns(int k, std::complex<double> z) noexcept;

/// Sum over impacts of (velocity jump) e^{-j k tau}.  Two integrations by parts turn the harmonics of a motion without
/// rests into these sums: no integral is left.
class JumpSum {
 public:
  /// @param state  just after the impact;  @param speed  before it
  void add(const GapState& state, double speed) noexcept {
    // Powers of e^{-j s} as in signed_powers of harmonics.cpp, here for each impact of a long motion.
    const double jump = state.velocity + speed;
    const double odd = jump * state.parity();
    const double even = state.wall == 0 ? jump : -jump;
    const double c = state.cos_s;
    const double s = state.sin_s;
    const double c2 = c * c - s * s;
    const double s2 = 2 * s * c;
    const double c3 = c * c2 - s * s2;
    const double s3 = s * c2 + c * s2;
    squared_speeds_ += speed * speed;
    sums_[0] += std::complex<double>(odd * c, -odd * s);
    sums_[1] += std::complex<double>(odd * c3, -odd * s3);
    sums_[2] += std::complex<double>(odd * (c3 * c2 - s3 * s2), -odd * (s3 * c2 + c3 * s2));
    sums_[3] += std::complex<double>(even * c2, -even * s2);
  }
  [[nodiscard]] const HarmonicSums& sums() const noexcept { return sums_; }
  /// Sum of the squared speeds before the impacts.
  [[nodiscard]] double squared_speeds() const noexcept { return squared_speeds_; }

 private:
  HarmonicSums sums_{};
  double squared_speeds_ = 0;
};

/// Harmonics of a closed orbit without rests over `half_periods` half periods of the force.
[[nodiscard]] Harmonics harmonics_of_jumps(const JumpSum& jumps, double gamma, double half_periods);

/// Integrals of u e^{-j k tau} flight by flight, in closed form or by series where that cancels.  Serves orbits with
/// rests and strong forces, where the velocity jumps are large and nearly cancel.
class FlightSum {
 public:
  /// @param start  state at the beginning of the flight, which ends after `flight.duration` radians
  void add_flight(const GapState& start, const Flight& flight) noexcept;
  /// An impact at which the nearer wall changes.  @param state  just after it
  void add_crossing(const GapState& state) noexcept;
  /// The tail of a chatter that begins at `state`.
  void add_tail(const GapState& state, const ChatterTail& tail) noexcept;
  /// Adds the sum of a motion that follows, or comes before.
  FlightSum& operator+=(const FlightSum& other) noexcept;
  /// Harmonics of the motion, which must be closed over `half_periods`, or, where their number is odd, be one mirror
  /// half of an orbit that is.
  [[nodiscard]] Harmonics harmonics(double gamma, double half_periods) const;

 private:
  HarmonicSums flights_{};
  HarmonicSums crossings_{};
};

}  // namespace backlash::detail
