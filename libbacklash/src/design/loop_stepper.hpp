// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "frac/identification/tune.hpp"

namespace backlash::detail {

/// A loop stepped in time: what persists, where the exact cycles do not tell.
struct SteppedLoop {
  const LinearBodies& bodies;
  Output measured;
  const frac::FractionalPidGains& gains;
  double derivative_filter_time;  // s
};

/// Both receptances are 1/(M s^2 + sum of c s^a).
[[nodiscard]] bool can_be_stepped(const LinearBodies& bodies);

/// Positions of the measured body, from rest at 0 but for a speed of the driven body, m/s.  Forces are held over a step
/// and an impact moves to the next sample, so that the motion errs by the share that a step is of a period.  Rests in
/// contact are impacts in every step.  Ends early where the motion leaves 10^6 clearances.
[[nodiscard]] std::vector<double> step_loop(const SteppedLoop& loop, double speed, double step, std::size_t steps);

}  // namespace backlash::detail
