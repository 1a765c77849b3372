// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "long_run_motion.hpp"
#include "two_impact_orbit.hpp"

namespace backlash::detail {

/// Follows the motion from a state at a peak of the force until its long-run behaviour is decided.
/// @param tolerance  an orbit is closed when its state repeats within it
[[nodiscard]] SteadyState find_steady_state(const GapMotion& motion, const GapState& start, double tolerance,
                                            const MeanGoal& goal = {});

/// A two-impact orbit as a steady state: the symmetric one in closed form, the others through their velocity jumps.
[[nodiscard]] SteadyState two_impact_steady_state(const TwoImpactOrbit& orbit, double restitution);

}  // namespace backlash::detail
