// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "motion/gap_motion.hpp"
#include "orbit_segment.hpp"
#include "steady_state/steady_state.hpp"

namespace backlash::detail {

/// Where searches for orbits begin: number `index` of an endless sequence that fills parameter, position and velocity
/// evenly.
struct SearchStart {
  double share;  // of the range of the parameter, in [0, 1)
  double position;
  double velocity;  // in [-1, 1), in units of the speeds of impacts that are to be expected
};
[[nodiscard]] SearchStart search_start(std::size_t index);
/// The state of a motion at the peak of the force.
[[nodiscard]] GapState state_of(const SearchStart& start, const GapMotion& motion);

/// The orbit that the motion settles on.  Empty where it does not close, rests or meets no wall.
/// @param at  gives the motion and the parameter of the branch; its impacts are not used
[[nodiscard]] std::optional<OrbitSegment> settled_orbit(const OrbitSegment& at, const GapState& start,
                                                        Transients transients);

/// Longest orbits that are looked for.
struct OrbitLimits {
  int period;   // force periods
  int impacts;  // per orbit
};
/// The orbits, stable or not, that motions come near to on their way: a state that nearly returns, or nearly becomes
/// its mirror image, is where Newton's iteration begins.  Most motions that wander chaotically pass near every unstable
/// orbit of short period, and branches of those lead on to where they are stable, however narrow that piece is and
/// however few starts it attracts.  Where motions soon settle or rest others are followed, from further on in the
/// sequence of starts.
/// @param index  of the first start; its place in the range is not used
[[nodiscard]] std::vector<OrbitSegment> orbits_passed(const OrbitSegment& at, std::size_t index,
                                                      const OrbitLimits& limits);

}  // namespace backlash::detail
