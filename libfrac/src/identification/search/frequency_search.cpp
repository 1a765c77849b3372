// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/frequency_search.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <utility>
#include <vector>

#include "base/linear_algebra.hpp"
#include "identification/search/linearisation.hpp"
#include "identification/search/start_values.hpp"

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

/// Means moved as little as makes the slope of their sum of squares by the variables that of all points; empty where
/// the model is not finite.
std::optional<Thinned> with_slope_of(const Linearisation& all, const FewResiduals& means,
                                     const std::vector<double>& theta) {
  const auto slope_of = [](const Linearisation& at) -> Eigen::VectorXd {
    return at.jacobian.transpose() * at.residuals();
  };
  const auto of_means = linearised(means.residuals, theta);
  if (!of_means) return std::nullopt;
  const Eigen::VectorXd shift = shortest_solution(of_means->jacobian.transpose(), slope_of(all) - slope_of(*of_means));
  const auto& [data, rule] = means.points;
  std::vector<std::complex<double>> value = data.value();
  for (std::size_t i = 0, row = 0; i < value.size(); ++i) {
    for (const std::complex<double> part : {std::complex<double>(1, 0), std::complex<double>(0, 1)}) {
      if (rule.form == (part.real() == 1 ? ResidualForm::imaginary : ResidualForm::real)) continue;
      value[i] -= part * shift[static_cast<Eigen::Index>(row++)] / rule.weight[i];
    }
  }
  return Thinned{{data.omega(), std::move(value)}, rule};
}

}  // namespace

FrequencySolution frequency_search(FrequencyProblem& problem, double hopeless, double settled) {
  // First iterations stay quick on so many points, and see the same shape.
  const FewResiduals few(problem, thinned(problem.data, problem.rule, 500));
  const bool blind = problem.options.global_start && !problem.map.free().empty();
  LocalOptions options;
  options.cost_tolerance = settled;
  FrequencySolution result{
      blind ? search_from_nothing(problem, few, hopeless) : search_from_start(problem, few, options), std::nullopt};
  if (result.starts_at_best == 0) return result;
  // The way along a valley is gone on means of very many points.
  if (problem.data.size() > many_points) {
    result.means = binned(problem.data, problem.rule, means_of_many);
    if (result.means) {
      result.best = local_solve(FewResiduals(problem, *result.means).residuals, result.best.theta, options);
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

void solve_also_from(const std::vector<double>& theta, FrequencyProblem& problem, FrequencySolution& solution) {
  LocalSolution other = solution.means ? local_solve(FewResiduals(problem, *solution.means).residuals, theta, {})
                                       : local_solve(problem.residuals(), theta, {});
  ++solution.starts;
  if (!(other.cost < solution.best.cost)) return;
  solution.best = std::move(other);
  solution.starts_at_best = 1;
  solution.confidence = confidence_of_optimum(solution.starts, ++solution.minima);
}

void refine_on_all(FrequencyProblem& problem, double settled, FrequencySolution& solution) {
  LocalOptions options;
  // A step that gains this share of the variance of a residual moves no estimate by more than a thousandth of its
  // standard error; sums of so many squares are known no better than some 1e-14.
  constexpr double gain = 1e-6;
  options.cost_tolerance = std::max(settled, gain / static_cast<double>(problem.residuals().count()));
  options.iterations = 1000;  // along a valley, which means follow at little cost
  options.radius = 1e12;      // so near, damping would make many steps of few along a valley
  Thinned means = *std::exchange(solution.means, std::nullopt);
  const Residuals& all = problem.residuals();
  LocalSolution& best = solution.best;
  // One round is enough nearly always: means stand for all points but for a small share of their information.
  constexpr int most_rounds = 5;
  for (int round = 0; round < most_rounds && !best.theta.empty(); ++round) {
    const auto at_best = linearised(all, best.theta);
    auto moved = at_best ? with_slope_of(*at_best, FewResiduals(problem, std::move(means)), best.theta) : std::nullopt;
    if (!moved) break;
    means = std::move(*moved);
    best.cost = best.objective = at_best->residuals().squaredNorm() + all.prior_cost(best.theta);
    const LocalSolution end = local_solve(FewResiduals(problem, means).residuals, best.theta, options);
    const double before = best.cost, after = all.cost(end.theta);
    if (after < before) best = {end.theta, after, after, true};
    if (end.converged && std::abs(after - before) <= options.cost_tolerance * before) return;
  }
  best = local_solve(all, best.theta, options);
  if (!std::isfinite(best.cost)) solution = {};
}

}  // namespace frac::detail
