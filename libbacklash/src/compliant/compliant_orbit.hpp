// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "compliant_run.hpp"

namespace backlash::detail {

/// A motion that repeats every `periods` of the force, up to the place of bodies that nothing holds.
struct CompliantOrbit {
  Eigen::VectorXd state;  // at a peak of the force
  CompliantMode mode;
  int periods;
  /// Of the map over all periods, on the states that repeat.
  Eigen::MatrixXd monodromy;
  /// Modulus of its largest multiplier.
  double largest_multiplier;
  double residual;  // of the repetition, over the sizes of the states
  std::int64_t contacts, sticks;
};

/// By Newton's method on the flow from a peak of the force.  Empty where it does not converge, or ends in other
/// contacts and slides than it began with.
[[nodiscard]] std::optional<CompliantOrbit> closed_orbit(const CompliantFlow& flow, const Eigen::VectorXd& state,
                                                         const CompliantMode& mode, int periods);

/// What is read from an orbit.
struct CompliantReading {
  std::complex<double> value;   // phasor of the position over the force, m/N
  bool is_symmetric;            // of one period, whose halves mirror each other
  std::complex<double> second;  // harmonic of the position over the force, m/N
  double third_ratio;           // of the position over the fundamental
  double work, loss;            // J per orbit: of the force; what contacts and friction take
  double moved;                 // J per orbit that the force gives and takes back
};
/// @param output  of which body
[[nodiscard]] CompliantReading read_orbit(const CompliantOrbit& orbit, const CompliantBodies& bodies,
                                          const SineForce& force, Output output, double tolerance);

}  // namespace backlash::detail
