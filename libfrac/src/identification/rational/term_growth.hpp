// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "frac/identification/model_library.hpp"
#include "growth.hpp"
#include "term_problem.hpp"

namespace frac::detail {

/// The best sums of each number of terms that was tried, simplest first, grown until neither of the last two numbers
/// paid.  BIC decides, with the search for the places of arcs paid for like that for poles; each sum has at least one
/// order that is searched for.
using TermLadder = GrowthLadder<TermFit>;

/// schwarz() with the search for places paid for, by price_of_place() or, of modes, price_of_point().
[[nodiscard]] double term_value(const TermProblem& problem, const TermFit& fit);

/// The best sums that a step of growth has come to, best first: the best one may have a term where another one belongs.
/// Of neighbours of nearly one cost, which are one sum found twice, only one counts.
/// @param kept      at most so many
/// @param value_of  of a fit: the less, the better
/// @param finished  a fit brought to its end
template <class Value, class Finish>
std::vector<TermFit> best_sums(std::vector<TermFit> grown, std::size_t kept, const Value& value_of,
                               const Finish& finished) {
  const auto below = [&](const TermFit& a, const TermFit& b) { return value_of(a) < value_of(b); };
  std::stable_sort(grown.begin(), grown.end(), below);
  std::vector<TermFit> best;
  for (std::size_t i = 0; i < grown.size() && best.size() < kept; ++i) {
    if (!std::isfinite(grown[i].cost)) break;
    const bool like_the_last = i > 0 && std::abs(grown[i].cost - grown[i - 1].cost) < 1e-3 * grown[i].cost;
    if (!like_the_last) best.push_back(finished(grown[i]));
  }
  std::stable_sort(best.begin(), best.end(), below);
  return best;
}
[[nodiscard]] TermLadder grow_terms(const TermProblem& problem, std::size_t most_terms);

/// The sum as a formula with start values.  Its name counts the terms: "terms:R+L+2arcs+power".
[[nodiscard]] NamedModel written_out(const TermProblem& problem, const TermSum& sum);

}  // namespace frac::detail
