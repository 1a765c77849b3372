// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/tune.hpp"

namespace frac::detail {

struct FoundController {
  FractionalPidGains gains;  // NaN where the equations for them have no solution
  int evaluations;
  int searches = 0;  // local ones from many points; none where the first search was enough
  int alike = 0;     // of which ended within 1 % of the best
};

/// The controller that keeps the specification and makes the criterion least, or comes nearest to keeping it, on a grid
/// of frequencies.
[[nodiscard]] FoundController search_controller(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                                                const TuningOptions& options);

}  // namespace frac::detail
