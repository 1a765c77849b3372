// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/limit_cycles.hpp"

namespace backlash {

/// A limit cycle as the describing function of the symmetric two-impact orbits predicts it: 1 + C(j omega) N(F, omega)
/// = 0, as if the controller answered to the fundamental alone.
struct PredictedCycle {
  double omega;            // rad/s
  double force_amplitude;  // N, peak
  /// Of the two orbits that one force amplitude has, that of the faster impacts, which is the one a sine force can keep
  /// up.
  bool faster_orbit;
  /// Loeb's criterion: a change of the amplitude dies out.
  bool stable;
  /// Third harmonic of the controller's force over the fundamental, by the orbit's third harmonic: far below 1 where
  /// the prediction can be trusted.
  double third_harmonic;
};

/// All of them, by rising omega.  With the load measured they lie where the rigid loop C/((M1 + M2) w^2) meets the
/// straight line -1/nu = pi^2/8 - pi/(4 (1 + eps) v) + j pi (1 - eps)/(4 (1 + eps)), v > 0.
/// @param range  where to look; by default wherever they can be, for a controller that is a sum of powers, else 1e-4 to
///               1e4 rad/s; on a grid as in LimitCycles, unless such a controller has no dead time and the load is
///               measured
/// @throws std::invalid_argument  a range that is none.
[[nodiscard]] std::vector<PredictedCycle> predicted_limit_cycles(const ControlLoop& loop,
                                                                 const std::optional<FrequencyRange>& range = {});

}  // namespace backlash
