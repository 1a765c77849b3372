// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "projection.hpp"

// Parts that the growths of all families have in common, whatever they grow and over whichever data.
namespace frac::detail {

/// Members of a growing family, simplest first.
template <class Fit>
struct GrowthLadder {
  std::vector<Fit> fits;
  std::size_t chosen = 0;                                  // the member of least value
  double value = std::numeric_limits<double>::infinity();  // of the chosen one: a criterion and the price of the search
  std::size_t in_vain = 0;                                 // members since then, which did not pay

  void add(Fit fit, double value_of_fit) {
    fits.push_back(std::move(fit));
    ++in_vain;
    if (!(value_of_fit < value)) return;
    value = value_of_fit;
    chosen = fits.size() - 1;
    in_vain = 0;
  }
  [[nodiscard]] const Fit& best() const { return fits.at(chosen); }
};

/// The cost at which a fit would have a value, that is by its cost n ln(cost), or no more than a least one, and more.
template <class Fit, class Value>
double cost_of_value(Fit fit, const Value& value_of, double value) {
  const double cost = fit.cost, here = value_of(fit);
  fit.cost *= std::numbers::e;
  const double n = value_of(fit) - here;
  return n > 0 ? cost * std::exp((value - here) / n) : std::numeric_limits<double>::infinity();
}

/// The fit without what does not pay for itself: of all moves from it the one of least value is taken, as long as there
/// is one of less.
/// @param shape     what problem.refine(shape, effort) starts from
/// @param moves_of  shapes to try instead of those of a fit, in a round counted from 0
template <class Problem, class Fit, class Shape, class Value, class Moves>
Fit without_idle(const Problem& problem, Fit best, Shape Fit::*shape, const Value& value_of, const Moves& moves_of) {
  constexpr int most_rounds = 30;
  double value = value_of(best);
  for (int round = 0; round < most_rounds; ++round) {
    bool better = false;
    Fit next = best;
    for (Shape& move : moves_of(best, round)) {
      const double wanted = cost_of_value(problem.refine(move, {0, scouting.tolerance}), value_of, value);
      Fit tried = problem.refine(std::move(move), scouting.in_reach_of(wanted));
      if (!(value_of(tried) < value)) continue;
      value = value_of(tried);
      next = std::move(tried);
      better = true;
    }
    if (!better) break;
    best = problem.refine(std::move(next.*shape), thorough);
    value = value_of(best);
  }
  return best;
}

}  // namespace frac::detail
