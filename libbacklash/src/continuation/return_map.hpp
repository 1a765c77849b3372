// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>

#include "orbit_segment.hpp"

namespace backlash::detail {

/// Map from the first impact to its next (mirrored) return, times the product of all speeds, which keeps it finite at
/// grazing.
struct ScaledReturnMap {
  std::array<double, 4> matrix;  // (phase, speed) by (phase, speed), row by row
  double scale;                  // product of the speeds
  double determinant;            // of the map itself: restitution^(2 impacts), exact
  [[nodiscard]] double trace() const noexcept { return (matrix[0] + matrix[3]) / scale; }
  /// Vanishes with 1 + trace + determinant: a multiplier -1.
  [[nodiscard]] double flip() const noexcept { return matrix[0] + matrix[3] + scale * (1 + determinant); }
  [[nodiscard]] bool stable() const noexcept;
};
[[nodiscard]] ScaledReturnMap return_map(const OrbitSegment& orbit);
/// Multipliers of the whole orbit, both halves of a symmetric one; the larger modulus first.
[[nodiscard]] std::array<std::complex<double>, 2> multipliers(const OrbitSegment& orbit);

/// Direction in the doubled space in which the halves part at a multiplier -1.
[[nodiscard]] Direction flip_direction(const OrbitSegment& orbit);

}  // namespace backlash::detail
