// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>

#include "backlash/describing_function.hpp"
#include "motion/gap_motion.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/long_run.hpp"
#include "support/random.hpp"

namespace support {

/// How many stated intervals miss the truth.
struct Tally {
  int scenes = 0;
  int closed = 0;
  int averaged = 0;
  int flagged = 0;         // averaged, and said to be of a transient perhaps
  int missed = 0;          // of those not flagged
  int missed_flagged = 0;  // of the others
  double seconds = 0;      // of the library
  [[nodiscard]] int stated() const { return scenes - flagged; }

  void add(const backlash::detail::SteadyState& steady, bool hit) {
    ++scenes;
    if (steady.regime == backlash::Regime::averaged) {
      ++averaged;
    } else {
      ++closed;
    }
    if (steady.transient_possible) ++flagged;
    if (!hit) ++(steady.transient_possible ? missed_flagged : missed);
  }
};

struct HonestScene {
  double restitution;
  double gamma;
  backlash::detail::GapState start;
};

/// Where chaotic transients last long: restitution 0.9 to 0.999, 1 - restitution log-uniform.
inline HonestScene transient_scene(Random& random) {
  const double restitution = 1 - random.log_uniform(1e-3, 0.1);
  const double omega = random.log_uniform(0.5, 4);
  return {restitution, 1 / (omega * omega), backlash::detail::state_at_peak(random.unit(), 0)};
}

template <typename Work>
backlash::detail::SteadyState timed(double& seconds, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  const backlash::detail::SteadyState steady = work();
  seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return steady;
}

/// Stated intervals against the motion after 10^5 force periods.  @param early  with the early stop of maps
inline Tally transients(int scenes, std::uint64_t seed, bool early, std::int64_t periods = 96'000) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const HonestScene scene = transient_scene(random);
    const backlash::detail::GapMotion motion(scene.gamma, scene.restitution);
    const backlash::detail::SteadyState steady = timed(tally.seconds, [&] {
      return find_steady_state(motion, scene.start, 1e-10, {early ? 0.01 : 0.0, -scene.gamma});
    });
    const LongRun truth = long_run(motion, scene.start, 100'000, periods);
    tally.add(steady, std::abs(steady.harmonics.u[0] - truth.u1) <= steady.uncertainty + truth.uncertainty);
  }
  return tally;
}

/// Two-impact orbits within 2e-4 of the frequency at which their symmetry breaks, against the closed form.
inline Tally pitchforks(int scenes, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const double restitution = random.uniform(0.1, 0.95);
    const double offset = random.log_uniform(1e-12, 4e-4) * (random.unit() < 0.5 ? -1 : 1);
    const double gamma = backlash::detail::symmetry_breaking_gamma(restitution) * (1 + offset);
    const auto orbit = backlash::detail::stable_two_impact_orbit(gamma, restitution);
    if (!orbit) continue;
    const std::complex<double> truth = two_impact_harmonics(*orbit, restitution).u[0];
    const backlash::detail::GapMotion motion(gamma, restitution);
    const backlash::detail::GapState start = state_at_next_peak(motion, orbit->start, 0);
    // Near the orbit, so that the scene does not lead elsewhere; far enough to be drawn to it slowly.
    const backlash::detail::GapState beside =
        backlash::detail::state_at_peak(start.position(), start.position_rate() + random.uniform(-0.02, 0.02));
    const backlash::detail::SteadyState steady =
        timed(tally.seconds, [&] { return find_steady_state(motion, beside, 1e-10); });
    // The asymmetric orbit and its mirror image have one describing function.
    tally.add(steady, std::abs(steady.harmonics.u[0] - truth) <= steady.uncertainty + 1e-12);
  }
  return tally;
}

/// U_1 + gamma of the symmetric two-impact orbit from the closed form in a wider type.  Masses and clearance are 1.
template <typename Wide>
std::complex<double> symmetric_u1_plus_gamma(double force, double omega, double restitution) {
  using std::sqrt;
  const Wide pi = 3.14159265358979323846264338327950288419716939937510L;
  const Wide gamma = Wide(force) / (Wide(omega) * Wide(omega));
  const Wide lost = 1 - Wide(restitution);
  const Wide kept = 1 + Wide(restitution);
  const Wide a = lost * lost + pi * pi * kept * kept / 4;
  const Wide half_b = pi * kept / 2;
  const Wide discriminant = half_b * half_b - a * (1 - 4 * gamma * gamma);
  const Wide speed = (half_b + (discriminant > 0 ? sqrt(discriminant) : Wide(0))) / a;
  const Wide jump = -2 * kept * speed / pi / (2 * gamma);
  return {static_cast<double>(jump * (1 - half_b * speed)), static_cast<double>(jump * speed * lost)};
}

/// The symmetric orbit near its saddle-node, against long double: 64 bits of mantissa leave 2^-11 of the uncertainty.
inline Tally saddle_nodes(int scenes, std::uint64_t seed) {
  Random random(seed);
  Tally tally;
  for (int i = 0; i < scenes; ++i) {
    const double restitution = random.uniform(0.1, 0.99);
    const double omega = random.log_uniform(0.1, 10);
    const double above = random.log_uniform(1e-15, 0.1);
    const double force = backlash::detail::saddle_node_gamma(restitution) * (1 + above) * omega * omega;
    backlash::SweepOptions options;
    options.protocol = backlash::Protocol::two_impact;
    const auto point =
        backlash::describing_function_sweep({1, 1, 1, restitution}, force, {omega}, options).points.front();
    if (point.regime != backlash::Regime::symmetric) continue;
    const std::complex<double> truth = symmetric_u1_plus_gamma<long double>(force, omega, restitution) / (-2 * force);
    ++tally.scenes;
    ++tally.closed;
    if (!(std::abs(point.value - truth) <= point.uncertainty)) ++tally.missed;
  }
  return tally;
}

}  // namespace support
