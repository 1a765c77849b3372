// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace frac::detail {

/// Where the zeros and poles of the best approximation of a fractional power gather as their number grows: the
/// equilibrium distribution on the negative real axis opposite the band +-j [e^-half_width, e^half_width].
///
/// With s = e^u the band is a slit Im u = pi/2 and the negative axis the line Im u = pi.  For Re u > 0 (the rest
/// follows by symmetry) cosh, a square, and a square root map the field between the two to a half-plane; with a =
/// e^(-half_width/2) the share of the flux that arrives between Re u = 0 and x is F(atan(v/a), k)/K(k), k^2 = 1 - a^4,
/// where sinh x = v sqrt(v^2 + 2 cosh half_width).
class FluxLaw {
 public:
  explicit FluxLaw(double half_width);

  /// Re u up to which the share |share| < 1 of the flux of one side arrives; odd in share.
  [[nodiscard]] double position(double share) const;

  /// `count` >= 2 values of ln omega from 0 to half_width, at equal steps of the flux that leaves the slit towards the
  /// negative axis: evenly spaced inside, closer at the edge.
  [[nodiscard]] std::vector<double> band_grid(int count) const;

 private:
  [[nodiscard]] double scaled_tangent(double share) const;

  double half_width_;
  std::vector<double> mean_;        // of the arithmetic-geometric mean of 1 and k'
  std::vector<double> difference_;  // of its steps
};

}  // namespace frac::detail
