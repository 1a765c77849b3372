// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/approximation/zero_pole_gain.hpp"

namespace frac {

/// Recursive approximation of s^order on a band (Oustaloup, Levron, Mathieu, Nanot 2000) with `poles` real poles and as
/// many real zeros for the fractional part a = order - trunc(order), -1 < a < 1; the whole part trunc(order) is exact.
/// oustaloup(-q) is the reciprocal of oustaloup(q).
/// On the edges of its own band the error never vanishes, however many poles: it tends to |(1-j)^a - 1| for the
/// fractional part a (46.6 % at a = 1/2).  Ask for a wider band than the one you use.
/// @throws std::invalid_argument  order not finite or |order| > 20, band not 0 < lower < upper < inf, poles < 1 or >
/// 1000.
[[nodiscard]] ZeroPoleGain oustaloup(double order, FrequencyBand band, int poles);

}  // namespace frac
