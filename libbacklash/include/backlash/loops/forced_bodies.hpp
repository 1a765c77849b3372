// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"

namespace backlash {

/// N(F, omega) of bodies with friction and springs: position phasor over that of a sine force on body 2.
/// With Protocol::two_impact the symmetric orbit with two impacts per period, of its faster impacts where the force has
/// two, comes first where it is stable: exact to rounding from sums over its harmonics.  Every other motion is followed
/// from event to event; one that closes after at most 32 force periods is solved exactly, with the whole memory of
/// fractional powers, one that rests in contact is followed until it repeats, and the rest is a mean with its 95 % half
/// width.  Starts at rest in contact are a quarter of the clearance off the middle on either side. Free masses are
/// those of describing_function_sweep().
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, positive, strictly rising, not empty
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed.
[[nodiscard]] DescribingFunctionSweep bodies_describing_function(const LinearBodies& bodies, double force_amplitude,
                                                                 const std::vector<double>& omega,
                                                                 const SweepOptions& options);

}  // namespace backlash
