// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Twice the logarithm of the odds of a fractional against an integer-order model, equal before.
/// @param share  of the points that carry news
[[nodiscard]] double evidence_for(const Competitor& fractional, const Competitor& integer, double share);

/// What the intervals of a fit say about its orders.
struct Orders {
  bool any_free = false;
  const ParameterEstimate* decided = nullptr;  // the one farthest (in intervals) from every whole number
  /// By how much evidence falls, to the curvature of the cost, on the way to the nearest order that departs(); 0 where
  /// one does already.
  double departure = std::numeric_limits<double>::infinity();
  bool all_nearly_whole = true;  // each known to be within 0.02 of one, which may lie outside the interval
};
[[nodiscard]] Orders orders_of(const FitResult& fit, double share);

/// Evidence of the best candidate with an order that departs() against the integer-order finalist.
struct Departure {
  double evidence = -std::numeric_limits<double>::infinity();
  std::size_t parameters = 0;
};
[[nodiscard]] Departure evidence_of_departure(const std::vector<Competitor>& competitors, const Competitor& integer,
                                              double share);

}  // namespace frac::detail
