// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace frac::detail {

/// The first instant that stands more than a thousandth of a step away from where even steps have it: a sine below half
/// the sampling rate turns by less than 3 mrad meanwhile, and files with three digits of a step keep to it.
[[nodiscard]] inline std::optional<std::size_t> first_uneven(const std::vector<double>& time) {
  constexpr double share = 1e-3;
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!(std::abs(time[i] - time.front() - static_cast<double>(i) * step) <= share * step)) return i;
  }
  return std::nullopt;
}

}  // namespace frac::detail
