// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "frac/power_term.hpp"

namespace backlash::detail {

/// The positive roots of sum c w^q, rising, all of them from 1e-60 to 1e60: between the roots of a derivative that has
/// one term less the sum is monotone.  A root of even order is listed once.
[[nodiscard]] std::vector<double> positive_roots(std::vector<frac::PowerTerm> sum);

/// Sign changes of a function between neighbouring grid points, refined; none where it is no number, nor at a pole.
/// @param scanned   the function at grid points, where its sign has to be right
/// @param rounding  where it is no larger at two neighbours it is 0 but for the rounding of its terms, and has no sign
[[nodiscard]] std::vector<double> roots_on_grid(const std::function<double(double)>& scanned,
                                                const std::function<double(double)>& function,
                                                const std::vector<double>& grid, double rounding = 0);

}  // namespace backlash::detail
