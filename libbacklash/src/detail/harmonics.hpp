#pragma once

#include <array>
#include <complex>

#include "detail/gap_motion.hpp"

namespace backlash::detail {

/// Orders k of the harmonics kept.  Even ones do not enter the describing function.
inline constexpr std::array<int, 3> harmonic_orders = {1, 3, 5};

/// Phasors U_k of u(tau) = Re sum U_k e^{j k tau}.
struct Harmonics {
  std::array<std::complex<double>, 3> u{};
  std::complex<double> u1_plus_gamma;  // U_1 + gamma, free of cancellation where the motion is nearly free
};

/// j^k z, exactly.
[[nodiscard]] std::complex<double> quarter_turns(int k, std::complex<double> z) noexcept;

/// Sum over impacts of (velocity jump) e^{-j k tau}.  Two integrations by parts turn the harmonics of a motion without
/// rests into these sums: no integral is left.
class JumpSum {
 public:
  /// @param state  just after the impact;  @param speed  before it
  void add(const GapState& state, double speed) noexcept;
  [[nodiscard]] const std::array<std::complex<double>, 3>& sums() const noexcept { return sums_; }

 private:
  std::array<std::complex<double>, 3> sums_{};
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
  /// Harmonics of the motion, which must be closed over `half_periods`, or be one mirror half of an orbit that is.
  [[nodiscard]] Harmonics harmonics(double gamma, double half_periods) const;

 private:
  std::array<std::complex<double>, 3> flights_{};
  std::array<std::complex<double>, 3> crossings_{};
};

}  // namespace backlash::detail
