// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/model/delayed_loop.hpp"
#include "frac/stability.hpp"

namespace frac {

/// Stability of a closed loop with dead time, forward/(1 + loop), which has infinitely many poles.  With forward =
/// N_F/D_F and loop = N/D e^{-Ts} they are the roots of D + N e^{-Ts}, counted by analyse_closed_loop(), and those of
/// D_F that D does not have: of 1/s behind a controller in the loop none is left, of an unstable model in front of it
/// all are.  A root that N and D share counts, as nothing drives what it stands for.
/// @return  stable, marginal, unstable, integrating, differentiating (forward grows with frequency) or undetermined,
/// and
///     the number of poles right of the imaginary axis; where D_F has some that stay, of these alone.
/// @throws std::invalid_argument  loop does not fall below 1 at high frequency.
[[nodiscard]] ClosedLoopStability analyse_closed_loop(const DelayedLoop& closed);

}  // namespace frac
