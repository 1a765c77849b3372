// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "identification/residuals/frequency_problem.hpp"
#include "identification/search/global_search.hpp"

namespace frac::detail {

/// The optimum of a fit to a frequency response: global_search() on a thinned copy of many points, finished on all;
/// from the start values alone where options.global_start is off.
/// @param hopeless  as global_search()
/// @param settled   relative change of the cost at which a solve from start values ends
/// @throws std::invalid_argument  a parameter without a start value where the search is off
[[nodiscard]] GlobalSolution frequency_search(FrequencyProblem& problem, double hopeless, double settled);

}  // namespace frac::detail
