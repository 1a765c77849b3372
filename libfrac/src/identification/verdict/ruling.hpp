// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "identification/verdict/evidence.hpp"

namespace frac::detail {

/// What a verdict weighs, besides the evidence and the predictions that stand in the result.
struct Comparison {
  const Competitor& fractional;
  const Competitor& integer;
  bool fractional_follows, integer_follows;  // the data: to within their noise or, where none does, their model error
  double share;                              // of the points that carry news
  Orders orders;                             // of the fractional one
  Departure departure;
  bool only_integer_grew;  // it is the member of a family, and no fractional family grew
  bool rounded;            // the values, so coarsely that their steps are a shape of their own
  bool over_time;
};

/// The verdict that the rules of IdentificationResult give on its evidence and predictions.
struct Ruling {
  Verdict verdict;
  std::string reason;  // ends the sentence that compares the two; what was missing where it is undecided
};
[[nodiscard]] Ruling ruling(const IdentificationResult& result, const Comparison& pair,
                            const std::vector<std::string>& skipped_rivals);

/// Whether evidence for one of two models, whose odds were equal before, leaves the other one out.
[[nodiscard]] bool decides(double evidence);

/// Whether the odds of the two classes follow from the departure evidence.  They do where the fractional finalist has
/// whole orders, so that its evidence does not speak for fractional orders, and where the verdict is not-supported
/// although evidence alone would not refuse.
[[nodiscard]] bool departure_decides(const IdentificationResult& result, const Comparison& pair, Verdict verdict);

/// Posterior odds of fractional to integer order: see IdentificationResult::log10_odds.
[[nodiscard]] double log10_odds(double evidence, Verdict verdict);

/// By how much evidence has to change for a verdict, whichever is farther.
[[nodiscard]] double evidence_to_decide(double evidence);
/// Evidence below it tells nothing.
inline constexpr double no_evidence = 2;

}  // namespace frac::detail
