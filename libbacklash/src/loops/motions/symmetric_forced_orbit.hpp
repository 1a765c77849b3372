// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>

#include "backlash/describing_function.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "loops/equations/forced_orbits.hpp"
#include "loops/equations/gap_response.hpp"

namespace backlash::detail {

/// The symmetric orbit of two impacts per period, of its faster impacts where the force has two, as a motion.
class SymmetricForcedOrbit {
 public:
  /// @param bodies    stay with the caller
  /// @param response  of the bodies alone
  SymmetricForcedOrbit(const LinearBodies& bodies, const ImpulseAnswer& response, double force, double omega);

  /// The force is large enough for it, impacts push, and between them it stays off the walls.
  [[nodiscard]] bool exists() const;
  [[nodiscard]] CycleStability stability() const;
  /// Whether it is stable, by the count of multipliers outside the unit circle alone.
  [[nodiscard]] bool is_stable() const;
  [[nodiscard]] DescribingFunctionPoint point(Output output, const CycleStability& stability) const;
  /// Roughly where the bodies are at a peak of the force.
  [[nodiscard]] LoopStart at_peak() const;

 private:
  // (x2 - x1)'' before the impact over minus the impulse, of the train and of the force.
  [[nodiscard]] double bend() const;

  const LinearBodies& bodies_;
  double asked_force_;
  ForcedOrbits orbits_;
  ImpulseTrain train_;
  double exchange_;
  ForcedOrbits::Orbit orbit_;
  std::complex<double> drive_;
  double omega_;
};

}  // namespace backlash::detail
