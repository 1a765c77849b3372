// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "motion/gap_motion.hpp"
#include "orbit_segment.hpp"

namespace backlash::detail {

/// Newton's iteration from a guess in the hyperplane through it normal to `normal`; with parameter_direction
/// at a fixed parameter. Empty when it does not converge.
[[nodiscard]] std::optional<OrbitSegment> corrected(const OrbitSegment& guess, const Direction& normal);
/// Unit tangent of the branch of orbits, on the side of `along`.  Empty where the branch is not regular.
[[nodiscard]] std::optional<Direction> tangent(const OrbitSegment& orbit, const Direction& along);

/// The orbit near a guess at its parameter, reduced to its mirror half or to one of several repeats.  Empty when
/// Newton's iteration finds none there.
[[nodiscard]] std::optional<OrbitSegment> corrected_to_shortest(const OrbitSegment& guess);
/// The orbit through a state, followed for that many impacts and half periods.
[[nodiscard]] std::optional<OrbitSegment> orbit_through(const GapMotion& motion, const GapState& on_orbit, int impacts,
                                                        int half_periods);

}  // namespace backlash::detail
