// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/tune.hpp"

namespace frac::detail {

/// Highest order of differentiation with which the loop still falls, as s^-0.2, at high frequency: beyond it no dead
/// time or lag is small enough to be left out of the model.
[[nodiscard]] double highest_mu(const FractionalTransferFunction& plant, const TuningOptions& options);

/// @throws std::invalid_argument  see tune().
void require_valid(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                   const TuningOptions& options);

}  // namespace frac::detail
