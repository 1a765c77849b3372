// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/model_library.hpp"
#include "rational_problem.hpp"

namespace frac::detail {

/// The fit as a formula with start values; its name is "rational:ZEROS/POLES", or "commensurate:ZEROS/POLES" with a
/// free order, and "+delay" behind it where it has one.
/// @param component  of the residuals: where it is blind to a constant, that stands apart in the formula
[[nodiscard]] NamedModel written_out(const RationalProblem& problem, const RationalShape& shape, Component component);

}  // namespace frac::detail
