// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

namespace frac::detail {

/// A dead time in samples.
struct SampledDeadTime {
  double samples;  // as given
  double whole;    // whole samples
  double rest;     // of a sample, 0 <= rest < 1
};

/// Splits a dead time; within rounding of a whole number of samples it is one.  The quotient of two rounded numbers is
/// off by some units in its last place, and a time by 1e-9 of a sample is beyond what anybody means.
[[nodiscard]] inline SampledDeadTime sampled_dead_time(double delay, double sample_time) {
  const double samples = delay / sample_time;
  const double nearest = std::round(samples);
  const double rounding = 1e-9 + 4 * std::numeric_limits<double>::epsilon() * samples;
  if (std::abs(samples - nearest) <= rounding) return {samples, nearest, 0};
  return {samples, std::floor(samples), samples - std::floor(samples)};
}

}  // namespace frac::detail
