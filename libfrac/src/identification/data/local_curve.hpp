// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace frac::detail {

/// The prediction of a point by its neighbours: weights with which a polynomial in the logarithm of frequency through
/// up to four of them is interpolated there.
struct LocalCurve {
  static constexpr std::size_t most_neighbours = 4;
  std::array<std::size_t, most_neighbours> neighbour{};
  std::array<double, most_neighbours> weight{};
  std::size_t count = 0;
  double noise = 1;  // standard deviation of a white error's distance from the curve, 1 for that of the error itself
};

/// The curve at `point` through the nearest two points on either side, or three where the data end on one side.
/// @param log_omega  increasing
/// @param usable     indices into it, increasing, `point` may be among them and takes no part
[[nodiscard]] LocalCurve local_curve(std::span<const double> log_omega, std::span<const std::size_t> usable,
                                     std::size_t point);

}  // namespace frac::detail
