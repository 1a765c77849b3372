// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/digital/c_header.hpp"

namespace frac {

/// Ranges of a filter in fixed point: a number of 32 bits is a fraction of them, from -1 to below 1.
struct FixedPointRanges {
  double input = 1;
  /// Outputs beyond it are cut.
  double output = 1;
};

/// A filter in whole numbers of 32 bits (Q31), sums and states in 64, for processors without a floating-point unit.
struct FixedPointHeader {
  /// A self-contained C99 header: <name>_init, <name>_reset and int32_t <name>_step(<name>_state *, int32_t sample).
  std::string text;
  /// Largest difference from the exact recursion of the design, in units of the output, for any input within its range
  /// and as long as no output is cut: rounding of coefficients, of samples, of states over all time, and of the output.
  double error_bound = 0;
};

/// @throws std::invalid_argument  the name; a range not positive and finite; a design with taps, pairs, differences,
/// integrators, dead time or no section; gains so large that the output range has less than 8 bits left.
[[nodiscard]] FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                                  const CHeaderOptions& options);

}  // namespace frac
