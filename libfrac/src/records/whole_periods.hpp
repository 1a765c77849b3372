// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac::detail {

/// Whole periods in a signal, to half a sample at its end.
[[nodiscard]] inline std::size_t whole_periods(std::size_t samples, double period) {
  return static_cast<std::size_t>((static_cast<double>(samples) + 0.5) / period);
}

}  // namespace frac::detail
