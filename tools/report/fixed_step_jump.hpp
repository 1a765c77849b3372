// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "report/table.hpp"

namespace report {

/// Jump laws that a fixed-step simulation would report for the ideal model: start in contact at rest, semi-implicit
/// Euler of 0.1 ms; the jump is the lowest frequency at which the second wall is not met within so many periods.
/// The exact answer is omega_L of equation (6) for any number of periods.
/// @param forces      N, at least two
/// @param clearances  m, positive, at least two
[[nodiscard]] Table fixed_step_jumps(const std::vector<double>& forces, const std::vector<double>& clearances,
                                     int threads);

}  // namespace report
