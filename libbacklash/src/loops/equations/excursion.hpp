// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace backlash::detail {

/// x2 - x1 and its rate.
struct GapSample {
  double value;
  double rate;
};

/// The largest |x2 - x1| strictly between two impacts: the ends, at the walls, do not count.
/// @param gap  at a time between 0 and half_period
[[nodiscard]] double largest_excursion(const std::function<GapSample(double)>& gap, double half_period);

}  // namespace backlash::detail
