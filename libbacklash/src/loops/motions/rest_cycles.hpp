// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "backlash/loops/impact_cycles.hpp"
#include "loop_run.hpp"

namespace backlash::detail {

/// A motion that rests in contact, seen from release to release.
struct RestPattern {
  LoopRun release;  // the last one
  int releases;     // after so many it repeats
  bool is_mirror;   // as its mirror image
};
/// The shortest of up to twelve releases that the last ones repeat to within `tolerance`.
/// @param releases  runs right after each, in their order
[[nodiscard]] std::optional<RestPattern> repeated_rests(const RealisedLoop& loop, const std::vector<LoopRun>& releases,
                                                        double tolerance);

/// The cycle next to a pattern.  Right after a release the state x lies where the gap is closed, its rate 0 and the
/// force of the contact 0; the motion to a later release maps these states onto each other, and Newton's method finds
/// what it leaves alone (or turns into its mirror image).  Bounces without end that lead to a rest are followed until
/// they are 1e-10 as fast as the motion: the momentum of both masses is kept there, so that what is left out is of the
/// square of that.  The derivative is one of differences over 1e-4 of the state, which Newton's method need not know
/// better; multipliers are known to 1e-6.
/// @param realised  of the loop, without a set-point and a limit of the force
[[nodiscard]] std::optional<ImpactCycle> close_rests(const ControlLoop& loop, const RealisedLoop& realised,
                                                     const RestPattern& pattern, int harmonics);

}  // namespace backlash::detail
