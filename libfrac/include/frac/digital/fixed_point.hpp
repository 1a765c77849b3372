// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <string>

#include "frac/digital/c_header.hpp"

namespace frac {

/// Ranges of a filter or controller in fixed point: a number of 32 bits is a fraction of them, from -1 to below 1.
struct FixedPointRanges {
  /// Range of the samples, or of set-point and measured value.
  double input = 1;
  /// Outputs beyond it are cut.
  double output = 1;
};

/// A filter or controller in whole numbers of 32 bits (Q31), sums and states in 64, for processors without a
/// floating-point unit.
struct FixedPointHeader {
  /// A self-contained C99 header: <name>_init, <name>_reset and int32_t <name>_step(<name>_state *, int32_t sample); of
  /// a controller int32_t <name>_step(<name>_state *, int32_t setpoint, int32_t measured) and <name>_track.
  std::string text;
  /// Largest difference from the exact recursion of the design, in units of the output, for any input within its range
  /// and as long as no output is cut: rounding of coefficients, of samples, of states over all time, and of the output.
  /// The integral of a filter goes on unseen while its output is cut, up to 16 output ranges, where it stops.
  double error_bound = 0;
  /// What the integral of a controller or a filter adds to it with every sample at most: without feedback its rounding
  /// adds up.
  double error_per_sample = 0;
  /// How far the output of a controller may exceed a limit before it is cut, in its units, for back calculation to draw
  /// the integral back as in the exact recursion: the input of the integral holds 4 input ranges.  Beyond, less is
  /// drawn back in a sample, and later outputs differ by more than the bound.  Infinite where nothing is drawn back.
  double exact_excess = std::numeric_limits<double>::infinity();
};

/// @throws std::invalid_argument  the name; a range not positive and finite; a design that DigitalFilter refuses, or
/// with more than one integrator, more than 100 000 samples of dead time, or a pair of complex poles damped less than
/// about one in a million; gains so large that the output range has less than 8 bits left.
[[nodiscard]] FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                                  const CHeaderOptions& options);

/// Limits beyond the output range are taken as that.
/// @throws std::invalid_argument  the name; a range not positive and finite; conditional integration, or set-point
/// weights beyond 0 to 1; gains so large that sums of 64 bits do not hold them.
[[nodiscard]] FixedPointHeader fixed_point_header(const FractionalPidDesign& design, const FixedPointRanges& ranges,
                                                  const CHeaderOptions& options);

}  // namespace frac
