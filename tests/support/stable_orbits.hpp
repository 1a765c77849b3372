// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "motion/gap_motion.hpp"

namespace support {

/// A stable closed orbit without rests that the event-driven motion has settled on.  Nothing but the motion itself is
/// used to find it: no Newton iteration, no closed form.
struct StableOrbit {
  int period;   // force periods
  int impacts;  // per orbit
  std::complex<double> u1;
  std::complex<double> u2;  // tells an asymmetric orbit from its mirror twin, which has the opposite one
};

/// Follows the motion until its states at the peaks of the force repeat after at most `longest_period` force periods,
/// to 1e-10 and over a hundred of them.  Empty where it meets no wall, rests or chatters to rest, or has not settled
/// after `most_periods`.
inline std::optional<StableOrbit> settle(const backlash::detail::GapMotion& motion,
                                         const backlash::detail::GapState& start, int longest_period,
                                         std::int64_t most_periods = 10'000) {
  using backlash::detail::GapState;
  using Complex = std::complex<double>;
  struct Peak {
    double position, rate;
    std::int64_t impacts;
    std::array<Complex, 2> jumps;  // sums of velocity jump times e^{-j k tau} up to here, k = 1, 2
  };
  constexpr double pi = std::numbers::pi;
  constexpr double repeated = 1e-10;
  constexpr std::ptrdiff_t repeats = 100;
  constexpr std::size_t looked_at_each = 500;
  constexpr double negligible_tail = 1e-14;
  std::vector<Peak> peaks;
  GapState state = start;
  std::int64_t next_peak = start.half_period + 2;
  std::int64_t impacts = 0, passed = 0;
  std::array<Complex, 2> jumps{};
  while (passed < most_periods) {
    if (motion.rests(state) || motion.chatter_tail(state).negligible(negligible_tail)) return std::nullopt;
    const backlash::detail::Flight flight = motion.next_flight(state);
    if (!flight.hits) return std::nullopt;
    const GapState next = motion.after_impact(state, flight);
    for (; next.half_period >= next_peak; next_peak += 2) {
      const auto at = motion.along(state, flight, radians_to_half_period(state, next_peak));
      peaks.push_back({state.wall == 0 ? at.distance : 1 - at.distance, state.wall == 0 ? at.velocity : -at.velocity,
                       impacts, jumps});
      ++passed;
    }
    const double jump = (next.wall == 0 ? 1 : -1) * (next.velocity + flight.speed);
    // tau = half_period pi - pi/2 + s
    const Complex turned = (next.half_period % 2 == 0 ? 1.0 : -1.0) * Complex(next.sin_s, next.cos_s);
    jumps[0] += jump * turned;
    jumps[1] += jump * turned * turned;
    ++impacts;
    state = next;
    if (peaks.size() < looked_at_each) continue;
    const auto last = static_cast<std::ptrdiff_t>(peaks.size()) - 1;
    // Furthest that a state is from the one `period` periods before.
    const auto change = [&](std::ptrdiff_t period) {
      double furthest = 0;
      for (auto a = peaks.begin() + last; a > peaks.begin() + last - repeats; --a) {
        const auto b = a - period;
        furthest = std::max(
            {furthest, std::abs(a->position - b->position), std::abs(a->rate - b->rate) / (1 + std::abs(a->rate))});
      }
      return furthest;
    };
    for (std::ptrdiff_t period = 1; period <= longest_period; ++period) {
      const double moved = change(period);
      // Nearly a period: the motion is still on its way, perhaps from side to side of a shorter orbit.
      if (moved > repeated && moved < 1e-5) break;
      if (moved > repeated) continue;
      const Peak& to = peaks[static_cast<std::size_t>(last)];
      const Peak& from = peaks[static_cast<std::size_t>(last - period)];
      // Two integrations by parts over the closed orbit leave the velocity jumps.
      const double scale = 1 / (pi * static_cast<double>(period));
      return StableOrbit{static_cast<int>(period), static_cast<int>(to.impacts - from.impacts),
                         -scale * (to.jumps[0] - from.jumps[0]) - motion.gamma(),
                         -0.25 * scale * (to.jumps[1] - from.jumps[1])};
    }
    peaks.clear();
  }
  return std::nullopt;
}

}  // namespace support
