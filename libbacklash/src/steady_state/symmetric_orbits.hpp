// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "steady_state.hpp"

namespace backlash::detail {

/// The stable symmetric two-impact orbits of one restitution, in closed form: v the larger root of
/// [(1-e)^2 + pi^2 (1+e)^2/4] v^2 - pi (1+e) v + 1 - 4 gamma^2 = 0, sin phi = -v (1-e)/(2 gamma), cos phi = [1 - pi
/// (1+e) v/2]/(2 gamma), U_k = -[gamma (k = 1) + 2 (1+e) v/pi e^{-j k phi}]/k^2 for odd k; their half-period map has
/// determinant e^2 and trace 2 e + (1+e) pi gamma cos(phi)/v.  From the two equations of a flight of pi radians from
/// u = 0 to 1 that starts and ends alike.
class SymmetricOrbits {
 public:
  /// Finds the range of gamma, where the orbit is stable and meets nothing else: the dear part.
  explicit SymmetricOrbits(double restitution);

  [[nodiscard]] bool contains(double gamma) const noexcept { return gamma >= first_ && gamma <= last_; }
  /// @param gamma  in the range.  `end` is left at its default: end_state gives it.
  [[nodiscard]] SteadyState at(double gamma) const noexcept;
  /// State at the peak of the force.
  [[nodiscard]] GapState end_state(double gamma) const;

 private:
  double restitution_;
  double first_;  // saddle-node
  double last_;   // pitchfork, or grazing
  double a_;      // coefficients of v^2 and v
  double inverse_a_;
  double half_b_;
};

}  // namespace backlash::detail
