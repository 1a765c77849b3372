// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "frac/power_term.hpp"

namespace frac::detail {

/// Whether all powers of a sum are integer ones.
[[nodiscard]] inline bool has_whole_orders(const std::vector<PowerTerm>& sum) {
  return std::all_of(sum.begin(), sum.end(),
                     [](const PowerTerm& term) { return term.order == std::round(term.order); });
}

}  // namespace frac::detail
