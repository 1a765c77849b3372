// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/orbit_continuation.hpp"

namespace backlash {

/// A limit cycle as the describing function predicts it: 1 + C(j omega) N(F, omega) = 0, as if the controller answered
/// to the fundamental (and to the mean) alone.
struct PredictedCycle {
  double omega;            // rad/s
  double force_amplitude;  // N, peak
  /// The impacts grow with the force amplitude.  Of the two symmetric orbits that one amplitude has, it is that of the
  /// faster impacts, which is the one a sine force can keep up.
  bool faster_orbit;
  /// Loeb's criterion: a change of the amplitude dies out.
  bool stable;
  /// Harmonics of the controller's force over the fundamental, by those of the orbit: far below 1 where the prediction
  /// can be trusted.  The second is 0 for a symmetric orbit.
  double third_harmonic;
  double second_harmonic;
  bool symmetric;   // the second half of the orbit is the mirror image of the first
  int impacts;      // per orbit
  int period;       // of the orbit, in periods of the force
  bool admissible;  // the orbit exists: it stays off the walls between its impacts
};

/// All of them on the orbits with two impacts per period, by rising omega.  With the load measured the symmetric ones
/// lie where the rigid loop C/((M1 + M2) w^2) meets the straight line -1/nu = pi^2/8 - pi/(4 (1 + eps) v) + j pi
/// kappa/4, v > 0, kappa = (1 - eps)/(1 + eps), and those with halves of unequal length, one of them the share d < 1/2
/// of the period, where it meets the curve
///   -1/nu = pi (1/2 - d)/sin(2 pi d) + j pi kappa/(2 (1 - cos(2 pi d))),
/// which leaves that line at 1/2 + j pi kappa/4.  An asymmetric orbit stands for its mirror image too.
/// @param range  where to look; by default wherever they can be, for a controller that is a sum of powers, else 1e-4 to
///               1e4 rad/s; on a grid as in LimitCycles, unless such a controller has no dead time and the load is
///               measured and the orbit is symmetric; asymmetric orbits of bodies that are no free masses on a grid of
///               60 points per decade and 16 shares of the period
/// @throws std::invalid_argument  a range that is none.
[[nodiscard]] std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop,
                                                                 const std::optional<FrequencyRange>& range = {});

/// Those on the branches of a diagram of free masses under a sine force but the orbits of two impacts per period, which
/// the other function has.  N (M1 + M2) w^2 of an orbit depends on F/(M2 clearance w^2) and the restitution alone: the
/// diagram may be of other masses, clearance and force, over any parameter but the restitution; what its range of that
/// ratio leaves out is left out here.
/// @param range  as above
/// @throws std::invalid_argument  a range that is none; a loop of bodies that are no free masses; a diagram of another
///                                restitution.
[[nodiscard]] std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop, const OrbitDiagram& orbits,
                                                                 const std::optional<FrequencyRange>& range = {});

/// The same on a diagram of its own, over F/(M2 clearance w^2) of 0.1 to 3: from where impacts are rare to where they
/// become contact.  It takes some seconds.
/// @throws std::invalid_argument  as above.
[[nodiscard]] std::vector<PredictedCycle> predicted_cycles_of_more_impacts(
    const ControlLoop& loop, const std::optional<FrequencyRange>& range = {});

}  // namespace backlash
