// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identification/residuals/frequency_problem.hpp"
#include "identification/search/global_search.hpp"
#include "identification/search/thinned.hpp"

namespace frac::detail {

/// Beyond so many points a fit is searched for on some of them.
inline constexpr std::size_t many_points = 20'000;
/// That many means stand for them until the last few steps.
inline constexpr std::size_t means_of_many = 2500;

struct FrequencySolution : GlobalSolution {
  /// The means of very many points over bins that it is the optimum of, which is that of all points to a small part of
  /// its standard errors; see refine_on_all().
  std::optional<Thinned> means;
};

/// The optimum of a fit to a frequency response: global_search() on a thinned copy of many points, finished on all, or
/// of very many on their means; from the start values alone where options.global_start is off.
/// @param hopeless  as global_search()
/// @param settled   relative change of the cost at which a solve from start values ends
/// @throws std::invalid_argument  a parameter without a start value where the search is off
[[nodiscard]] FrequencySolution frequency_search(FrequencyProblem& problem, double hopeless, double settled);

/// Another local solve, from theta: where it ends lower, that is the solution.
void solve_also_from(const std::vector<double>& theta, FrequencyProblem& problem, FrequencySolution& solution);

/// From the optimum of means to that of all points.
void refine_on_all(FrequencyProblem& problem, double settled, FrequencySolution& solution);

}  // namespace frac::detail
