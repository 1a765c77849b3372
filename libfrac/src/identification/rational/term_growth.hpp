// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/model_library.hpp"
#include "growth.hpp"
#include "term_problem.hpp"

namespace frac::detail {

/// The best sums of each number of terms that was tried, simplest first, grown until neither of the last two numbers
/// paid.  BIC decides, with the search for the places of arcs paid for like that for poles; each sum has at least one
/// order that is searched for.
using TermLadder = GrowthLadder<TermFit>;
[[nodiscard]] TermLadder grow_terms(const TermProblem& problem, std::size_t most_terms);

/// The sum as a formula with start values.  Its name counts the terms: "terms:R+L+2arcs+power".
[[nodiscard]] NamedModel written_out(const TermProblem& problem, const TermSum& sum);

}  // namespace frac::detail
