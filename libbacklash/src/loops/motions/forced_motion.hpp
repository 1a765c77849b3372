// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "backlash/loops/simulate_loop.hpp"

namespace backlash::detail {

/// The end of a motion under a force of given frequency.
struct ForcedMotion {
  DescribingFunctionPoint point;
  LoopStart end;  // where the motion was last at a peak of the force
};

/// Follows the motion from event to event: to a closed orbit, which Newton's method then solves exactly, with the whole
/// memory of fractional powers; to one that rests in contact every period and repeats; to no impacts; else a mean with
/// the 95 % half width of batch means.
/// @param start  at a peak of the force
[[nodiscard]] ForcedMotion follow_forced(const LinearBodies& bodies, double force, double omega, const LoopStart& start,
                                         const SweepOptions& options);

/// A point of which nothing is known yet.
[[nodiscard]] DescribingFunctionPoint empty_point(double omega);
/// Body 1 at rest where its own springs hold it; body 2 about the middle of the clearance.
[[nodiscard]] DescribingFunctionPoint free_point(const LinearBodies& bodies, double omega, Output output);

}  // namespace backlash::detail
