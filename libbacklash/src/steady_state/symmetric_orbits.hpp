// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "long_run_motion.hpp"
#include "two_impact_orbit.hpp"

namespace backlash::detail {

/// The stable symmetric two-impact orbits of one restitution, in closed form: U_k = -[gamma (k = 1) + 2 (1+e) v/pi
/// e^{-j k phi}]/k^2 for odd k; their half-period map has determinant e^2 and trace 2 e + (1+e) pi gamma cos(phi)/v.
class SymmetricOrbits {
 public:
  /// Expensive: finds the range of gamma in which the orbit is stable and meets nothing else.
  explicit SymmetricOrbits(double restitution);

  [[nodiscard]] bool contains(double gamma) const noexcept { return gamma >= first_ && gamma <= last_; }
  /// @param gamma  in the range.  `end` is left at its default: end_state gives it.
  [[nodiscard]] SteadyState at(double gamma) const noexcept;
  /// State at the peak of the force.
  [[nodiscard]] GapState end_state(double gamma) const;

 private:
  double restitution_;
  SymmetricFamily family_;
  double first_;  // saddle-node
  double last_;   // pitchfork, or grazing
};

}  // namespace backlash::detail
