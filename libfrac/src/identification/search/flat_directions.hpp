// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "local_solve.hpp"

namespace frac::detail {

/// Directions of theta, their largest entry 1, along which a step of 1 adds less than `times` the cost, as the
/// curvature at the solution says.
[[nodiscard]] std::vector<std::vector<double>> flat_directions(const Residuals& residuals,
                                                               const LocalSolution& solution, double times);

}  // namespace frac::detail
