// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>

#include "motion/gap_motion.hpp"

namespace support {

/// Mean of the first harmonic over a long run that looks for nothing: no orbit is closed, no transient is judged.
struct LongRun {
  std::complex<double> u1;  // of u(tau) = Re U_1 e^{j tau}
  double uncertainty;       // twice the standard error of 16 batches, and the ends of a run that does not close
};

/// Follows the motion for `skipped` force periods and averages over the next `averaged` ones (a multiple of 16).
/// u'' is the force, the velocity jumps of the impacts and, while the mass lies on a wall, the force of the wall; two
/// integrations by parts turn them into the mean of u e^{-j tau}.
inline LongRun long_run(const backlash::detail::GapMotion& motion, const backlash::detail::GapState& start,
                        std::int64_t skipped, std::int64_t averaged) {
  using backlash::detail::DistanceAndVelocity;
  using backlash::detail::Flight;
  using backlash::detail::GapState;
  using Complex = std::complex<double>;
  constexpr double pi = std::numbers::pi;
  constexpr int batches = 16;
  constexpr double negligible_tail = 1e-14;
  const auto phasor = [](const GapState& state) {  // e^{-j tau}, tau = half_period pi - pi/2 + s
    const double sign = state.half_period % 2 == 0 ? 1 : -1;
    return sign * Complex(state.sin_s, state.cos_s);
  };
  GapState state = start;
  std::int64_t next_peak = start.half_period + 2 * skipped;
  const std::int64_t step = 2 * averaged / batches;
  std::array<Complex, batches + 1> integral{};  // at the peaks between batches
  std::size_t passed = 0;
  Complex pushes = 0;
  const auto pass_peaks = [&](std::int64_t until, const auto& at) {
    for (; until >= next_peak && passed <= batches; next_peak += step) {
      const auto [position, rate] = at(next_peak);
      integral[passed++] = Complex(rate, position) - pushes;
    }
  };
  while (passed <= batches) {
    if (motion.rests(state) || motion.chatter_tail(state).negligible(negligible_tail)) {
      const GapState release = motion.release_after(state);
      // The wall cancels the force; at a peak within the rest it has done so up to there.
      const double gamma = motion.gamma();
      const auto antiderivative = [](Complex e, double tau) { return 0.5 * tau + Complex(0, 0.25) * e * e; };
      const double length = static_cast<double>(release.half_period - state.half_period) * pi + release.s - state.s;
      const Complex before = antiderivative(phasor(state), 0);
      const Complex pushes_before = pushes;
      pass_peaks(release.half_period, [&](std::int64_t peak) {
        const double to_peak = backlash::detail::radians_to_half_period(state, peak);
        pushes = pushes_before - gamma * (antiderivative(1, to_peak) - before);
        return std::pair(state.wall == 0 ? 0.0 : 1.0, 0.0);
      });
      // A chatter that is cut off also loses its velocity at the wall.
      const double lost = state.wall == 0 ? -state.velocity : state.velocity;
      pushes = pushes_before + lost * phasor(state) - gamma * (antiderivative(phasor(release), length) - before);
      state = release;
      continue;
    }
    const Flight flight = motion.next_flight(state);
    if (!flight.hits) return {-motion.gamma(), 0};
    const GapState next = motion.after_impact(state, flight);
    pass_peaks(next.half_period, [&](std::int64_t peak) {
      const DistanceAndVelocity at = motion.along(state, flight, backlash::detail::radians_to_half_period(state, peak));
      return state.wall == 0 ? std::pair(at.distance, at.velocity) : std::pair(1 - at.distance, -at.velocity);
    });
    const double jump = next.velocity + flight.speed;
    pushes += (next.wall == 0 ? jump : -jump) * phasor(next);
    state = next;
  }
  const double scale = 1 / (pi * static_cast<double>(averaged));
  LongRun run{scale * (integral[batches] - integral[0]) - motion.gamma(), 0};
  double squares = 0;
  for (std::size_t i = 0; i < batches; ++i) {
    squares += std::norm(double{batches} * scale * (integral[i + 1] - integral[i]) - motion.gamma() - run.u1);
  }
  const double speed = std::abs(integral[batches].real() - integral[0].real());
  run.uncertainty = 2 * std::sqrt(squares / (batches - 1.0) / batches) + scale * std::min(speed, 2 * motion.gamma());
  return run;
}

}  // namespace support
