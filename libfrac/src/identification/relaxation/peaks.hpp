// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace frac::detail {

/// A maximum and the minima around it, by index.
struct PeakRange {
  std::size_t first, top, last;
};

/// The maxima of a density inside its range that stand out from the higher of their minima by a hundredth of their
/// height.
[[nodiscard]] std::vector<PeakRange> peak_ranges(std::span<const double> density);

/// Neighbours between which the density may as well not fall, joined: the lower end of the smaller maximum is not above
/// the upper end of the minimum.
[[nodiscard]] std::vector<PeakRange> joined_peaks(std::vector<PeakRange> ranges, std::span<const double> density,
                                                  std::span<const double> lower, std::span<const double> upper);

/// Keeps the peaks that hold more than a thousandth of the whole area.
/// @param beside  what lines hold of it
[[nodiscard]] std::vector<PeakRange> large_peaks(std::vector<PeakRange> ranges, std::span<const double> log_tau,
                                                 std::span<const double> density, double beside = 0);

/// Whether a peak is no wider than one of a single time is drawn: it has fallen to half its height two nodes from its
/// top.  Its place is the mean of the nodes about the top by weight, which is that time where it lies between two.
[[nodiscard]] bool is_narrow(std::span<const double> density, std::size_t top);

/// Place of the parabola through the maximum of a range and its neighbours.
[[nodiscard]] double peak_place(std::span<const double> log_tau, std::span<const double> density,
                                const PeakRange& range);

/// Integral by the trapezoidal rule.
[[nodiscard]] double peak_area(std::span<const double> log_tau, std::span<const double> density,
                               const PeakRange& range);

}  // namespace frac::detail
