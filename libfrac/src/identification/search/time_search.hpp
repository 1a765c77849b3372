// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "global_search.hpp"
#include "identification/residuals/time_problem.hpp"

namespace frac::detail {

/// Fits the Laplace transforms of the record, weighed towards its beginning in three ways, and simulations of a part of
/// the samples from there and from the given starts; then looks about the best of them, seeded, until enough of the
/// solves from there come back.  The best ends in a solve of all samples.
/// @param hopeless  cost, in the unit of FitResult, above which nobody looks about the best fit to the transforms
/// @param settled   relative change of the cost at which the last solve ends
[[nodiscard]] GlobalSolution time_search(const TimeProblem& problem, double hopeless, double settled);

}  // namespace frac::detail
