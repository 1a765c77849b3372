// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>

namespace report {

/// Two masses with clearance, forced by F cos(omega t) on mass 2, as a fixed-step simulation tool treats them.  It is
/// here to be compared with, not to be used: its results converge with the first power of the step.
struct FixedStepScene {
  double mass1, mass2;     // kg
  double clearance;        // m, > 0
  double restitution;      // in [0, 1]
  double force_amplitude;  // N
};

/// State of the relative and of the common motion.
struct FixedStepState {
  double time = 0;                      // s
  double position1 = 0, velocity1 = 0;  // m, m/s
  double position2 = 0, velocity2 = 0;
};

/// Semi-implicit Euler: velocities first, positions from the new velocities.  An impact is noticed at the end of the
/// step in which a wall was crossed; the velocities then follow Newton's rule and the penetration is taken back about
/// the centre of mass, which is what tools without event location do.
/// @param cosine  cos(omega state.time)
inline void fixed_step(const FixedStepScene& scene, double cosine, double step, FixedStepState& state) {
  state.velocity2 += step * scene.force_amplitude * cosine / scene.mass2;
  state.position1 += step * state.velocity1;
  state.position2 += step * state.velocity2;
  state.time += step;
  const double gap = state.position2 - state.position1;
  const double relative_velocity = state.velocity2 - state.velocity1;
  const bool lower = gap < 0 && relative_velocity < 0;
  const bool upper = gap > scene.clearance && relative_velocity > 0;
  if (!lower && !upper) return;
  const double total = scene.mass1 + scene.mass2;
  const double change = (1 + scene.restitution) * relative_velocity;
  state.velocity1 += scene.mass2 / total * change;
  state.velocity2 -= scene.mass1 / total * change;
  const double penetration = gap - std::clamp(gap, 0.0, scene.clearance);
  state.position1 += scene.mass2 / total * penetration;
  state.position2 -= scene.mass1 / total * penetration;
}

/// Initial state at rest with the gap y = x2 - x1 at `share` of the clearance, the centre of mass moving such that it
/// does not drift away: under F cos(omega t) its steady motion is -F/((m1 + m2) omega^2) cos(omega t).
inline FixedStepState fixed_step_start(const FixedStepScene& scene, double omega, double share) {
  const double total = scene.mass1 + scene.mass2;
  const double centre = -scene.force_amplitude / (total * omega * omega);
  FixedStepState state;
  state.position1 = centre - scene.mass2 / total * share * scene.clearance;
  state.position2 = centre + scene.mass1 / total * share * scene.clearance;
  return state;
}

/// Describing function of mass 1 in m/N: `settle` periods are run off, the fundamental is summed over the next
/// `measure`.
/// @param steps_per_period  >= 8; the step is the period divided by it
inline std::complex<double> fixed_step_describing_function(const FixedStepScene& scene, double omega,
                                                           std::size_t steps_per_period, std::size_t settle,
                                                           std::size_t measure) {
  const double step = 2 * std::numbers::pi / omega / static_cast<double>(steps_per_period);
  FixedStepState state = fixed_step_start(scene, omega, 0.5);
  std::complex<double> sum = 0;
  for (std::size_t period = 0; period < settle + measure; ++period) {
    // The phase of the force is taken anew in each period, so that it does not collect rounding.
    state.time = 0;
    for (std::size_t k = 0; k < steps_per_period; ++k) {
      fixed_step(scene, std::cos(omega * state.time), step, state);
      if (period >= settle) {
        const double angle = omega * state.time;
        sum += state.position1 * std::complex<double>(std::cos(angle), -std::sin(angle));
      }
    }
  }
  return 2.0 * sum / static_cast<double>(measure * steps_per_period) / scene.force_amplitude;
}

}  // namespace report
