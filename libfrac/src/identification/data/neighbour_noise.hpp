// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

namespace frac::detail {

/// Standard deviation of the noise in samples y of a smooth curve over x: 1.4826 times the median distance of a sample
/// from the straight line through its two neighbours, in units of what noise alone would give it.
/// @param x  rising; equal neighbours are repeats
[[nodiscard]] double neighbour_noise(std::span<const double> x, std::span<const double> y);

}  // namespace frac::detail
