// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "frac/approximation/zero_pole_gain.hpp"

namespace frac::detail {

/// Largest |order| that Oustaloup and Gruenwald-Letnikov realise.
inline constexpr double largest_realised_order = 20;

/// @throws std::invalid_argument  order not finite or |order| > 20; the text begins with `where`.
void check_realised_order(double order, std::string_view where);

/// @throws std::invalid_argument  band not 0 < lower < upper < infinity, or poles not in 1 to 1000.
void check_oustaloup(FrequencyBand band, int poles);

}  // namespace frac::detail
