// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/frequency_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "identification/search/start_values.hpp"
#include "identification/search/thinned.hpp"

namespace frac::detail {
namespace {

/// The problem at few of its points, at few of these again, or at means of them.
struct FewResiduals {
  FewResiduals(const FrequencyProblem& problem, Thinned few)
      : points(std::move(few)),
        residuals(points.data, problem.structure, problem.options.realisation, problem.map, points.rule,
                  problem.options.assumptions.stable == true && problem.options.global_start) {
    residuals.set_priors(problem.priors, expected_noise);
  }
  Thinned points;
  FrequencyResiduals residuals;
};

GlobalSolution search_from_nothing(const FrequencyProblem& problem, const FewResiduals& few, double hopeless) {
  const FrequencyResponseData& data = few.points.data;
  // So few that scouting is quick and so many that they show the shape of most curves; see global_search().
  const std::size_t scouted = std::max<std::size_t>(64, 8 * problem.map.free().size());
  const std::vector<double> orders = suggested_orders(data);
  const std::uint64_t seed = problem.options.seed;
  if (2 * data.size() < 3 * scouted) return global_search(few.residuals, few.residuals, orders, seed, hopeless);
  const FewResiduals fewer(problem, thinned(data, few.points.rule, scouted));
  return global_search(fewer.residuals, few.residuals, orders, seed, hopeless);
}

/// The solve from the start values; `starts_at_best` is 0 where the model is not finite there.
GlobalSolution search_from_start(FrequencyProblem& problem, const FewResiduals& few, const LocalOptions& options) {
  require_start_values(problem.map, problem.structure);
  GlobalSolution result;
  result.starts = 1;
  result.minima = 1;
  result.confidence = std::numeric_limits<double>::quiet_NaN();
  result.best.theta = problem.map.to_theta(problem.map.start());
  if (!std::isfinite(problem.residuals().cost(result.best.theta))) return result;
  result.best = local_solve(few.residuals, result.best.theta, options);
  result.starts_at_best = 1;
  return result;
}

}  // namespace

FrequencySolution frequency_search(FrequencyProblem& problem, double hopeless, double settled) {
  // First iterations stay quick on so many points, and see the same shape.
  const FewResiduals few(problem, thinned(problem.data, problem.rule, 500));
  const bool blind = problem.options.global_start && !problem.map.free().empty();
  LocalOptions options;
  options.cost_tolerance = settled;
  FrequencySolution result{blind ? search_from_nothing(problem, few, hopeless)
                                 : search_from_start(problem, few, options)};
  if (result.starts_at_best == 0) return result;
  // The way along a valley is gone on means of very many points.
  constexpr std::size_t bins = 10'000;
  if (problem.data.size() > 2 * bins) {
    if (auto means = binned(problem.data, problem.rule, bins)) {
      result.best = local_solve(FewResiduals(problem, std::move(*means)).residuals, result.best.theta, options);
      result.is_of_means = true;
      if (!std::isfinite(result.best.cost)) return {};
      return result;
    }
  }
  if (few.points.data.size() < problem.data.size()) {
    result.best = local_solve(problem.residuals(), result.best.theta, options);
  }
  if (!std::isfinite(result.best.cost)) return {};
  return result;
}

void refine_on_all(FrequencyProblem& problem, double settled, FrequencySolution& solution) {
  LocalOptions options;
  // So near, steps need no damping, which would make many of the last few along a valley.
  options.radius = 1e12;
  // A step that gains this share of the variance of a residual moves no estimate by more than a thousandth of its
  // standard error; sums of so many squares are known no better than some 1e-14.
  constexpr double gain = 1e-6;
  options.cost_tolerance = std::max(settled, gain / static_cast<double>(problem.residuals().count()));
  solution.best = local_solve(problem.residuals(), solution.best.theta, options);
  solution.is_of_means = false;
  if (!std::isfinite(solution.best.cost)) solution = {};
}

}  // namespace frac::detail
