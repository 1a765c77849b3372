// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"

namespace backlash {

/// N(F, omega) of bodies with friction and springs: position phasor over force phasor of the symmetric orbit with two
/// impacts per period under a sine force on body 2, exact to rounding, with its stability; that of the faster impacts
/// where the force has two.  Where body 2 alone does not reach a wall, that motion without impacts.
/// Elsewhere the motion is another one, which is not followed: the value is NaN and the regime `averaged`.
/// Free masses are those of describing_function_sweep() with Protocol::two_impact, every motion followed.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, positive, strictly rising, not empty
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed.
[[nodiscard]] DescribingFunctionSweep bodies_describing_function(const LinearBodies& bodies, double force_amplitude,
                                                                 const std::vector<double>& omega,
                                                                 Output output = Output::x1);

}  // namespace backlash
