// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/tune.hpp"

namespace frac::detail {

/// Fills in what the loop of result.gains reaches: stability, margins, peaks, integrals and each line of the
/// specification.
void describe_loop(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options, TuningResult& result);

}  // namespace frac::detail
