// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace frac::detail {

/// The upper median; 0 of nothing.
[[nodiscard]] inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Standard deviation of normally distributed scatter of which these are the distances from its centre, some outliers
/// among them or not.
[[nodiscard]] inline double robust_deviation(std::vector<double> distances) {
  return 1.4826 * median(std::move(distances));
}

}  // namespace frac::detail
