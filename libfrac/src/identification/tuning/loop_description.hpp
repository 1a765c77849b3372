// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/tune.hpp"

namespace frac::detail {

/// Fills in what the loop of result.gains reaches: stability, margins, peaks, integrals and each line of the
/// specification.
/// @param reference  a frequency about which the loop lives, rad/s; it is looked at over ten decades about it
void describe_loop(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options, double reference, TuningResult& result);

}  // namespace frac::detail
