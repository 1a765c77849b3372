// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "backlash/describing_function.hpp"
#include "motion/gap_motion.hpp"
#include "motion/harmonics.hpp"

namespace backlash::detail {

/// Long-run motion that a starting state leads to.
struct SteadyState {
  Regime regime;
  int period;                 // force periods; 0 when averaged
  double impacts_per_period;  // infinity for complete chatter
  Harmonics harmonics;
  double uncertainty;      // of |U_1|
  double spectral_radius;  // of the orbit's period map; NaN when averaged or free
  double energy_defect;    // |work of the force - impact losses| over the energy of relative motion that impacts meet
  double lyapunov;         // largest exponent per force period; -infinity where every disturbance is forgotten
  GapState end;            // a state at a peak of the force on (or, when averaged, near) the long-run motion
  double periods_followed = 0;      // of an averaged motion, from its start on
  bool transient_possible = false;  // averaged over what may not be the long-run motion yet
  // Change of U_1 per relative change of the force, of an orbit lost in rounding; NaN elsewhere.
  double force_sensitivity = std::numeric_limits<double>::quiet_NaN();
};

/// Whether a chaotic motion is followed until it has outlasted the transients that are known at its restitution.
enum class Transients { outlasted, ignored };

/// When the mean of a motion that does not close is good enough to stop early.
struct MeanGoal {
  double relative = 0;  // uncertainty of U_1 over |U_1 - zero|; 0: follow the whole window
  double zero = 0;      // U_1 at which the describing function vanishes
  Transients transients = Transients::outlasted;
  // A motion that rests again and again is given up there, as an averaged one: its harmonics are not asked for.
  bool leaves_rests = false;
};

/// Where chatter may be cut off: what is neglected of the integral of the distance.  |Im U| is of the order
/// gamma^(-1/3) or 1.
[[nodiscard]] double tail_limit(const GapMotion& motion, double tolerance);

/// Work of the force on the relative motion over its losses, both over a time of `half_periods` and per unit of reduced
/// mass: the work is pi gamma |Im U_1| per period, the losses (1 - restitution^2) v^2/2 per impact and those of a
/// chatter that is cut off.
[[nodiscard]] double energy_defect(const GapMotion& motion, const Harmonics& harmonics, double half_periods,
                                   double squared_speeds, double tail_loss = 0);

}  // namespace backlash::detail
