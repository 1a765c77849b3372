#pragma once

#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// Some formulas mean the same with two groups of parameters exchanged: q1, a1 and q2, a2 in 1/(a2 s^q2 + a1 s^q1 + 1).
/// Of groups whose names differ in their last number alone, none of them constrained, the one with the higher number
/// gets the higher order; of other pairs of an order and a coefficient, the one that the formula names first.
[[nodiscard]] std::vector<double> canonical_labels(const Structure& structure,
                                                   const std::vector<ParameterConstraint>& constraints,
                                                   std::vector<double> parameters);

}  // namespace frac::detail
