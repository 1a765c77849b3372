// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "long_run_motion.hpp"
#include "motion/gap_motion.hpp"

namespace backlash::detail {

/// Long-run motion of a mass that sticks and is known to do so again after `release`.  A stick forgets what was before,
/// so that the motion from one release to the next is the whole orbit, or half of it when the next one is from the
/// opposite wall.  Where it lasts longer than `longest_period` force periods, or amplifies rounding so much that the
/// true orbit is another one than that computed, the mean over many such motions is given instead, with its 95 % half
/// width.
/// @param course  mean of the impacts since `release`, in place of what cannot be told from one orbit
[[nodiscard]] SteadyState sticking_motion(const GapMotion& motion, const GapState& release, double tolerance,
                                          const MeanGoal& goal, int longest_period, const SteadyState& course);

}  // namespace backlash::detail
