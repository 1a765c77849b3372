// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/describing_function.hpp"
#include "steady_state.hpp"

namespace backlash::detail {

/// Beyond this dimensionless force the clearance moves no digit of N: |U|/gamma < 1e-30.
inline constexpr double rigid_force = 1e30;
/// Below it the mass would take more periods to reach a wall than are followed.
inline constexpr double free_force = 1e-30;

/// The describing function of a steady state.
[[nodiscard]] DescribingFunctionPoint point_of(const TwoMassSystem& system, double omega, double gamma, Output output,
                                               const SteadyState& steady);

/// The accuracy of a mean that these options ask for.
[[nodiscard]] MeanGoal mean_goal(const TwoMassSystem& system, double gamma, const SweepOptions& options);

/// @throws std::invalid_argument  tolerance, mean_tolerance or threads out of range.
void require_valid(const SweepOptions& options);

}  // namespace backlash::detail
