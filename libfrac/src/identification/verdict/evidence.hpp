// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "identification/statistics/assumption_evidence.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Twice the logarithm of the odds of a fractional against an integer-order model, equal before.
/// @param share  of the points that carry news
[[nodiscard]] double evidence_for(const Competitor& fractional, const Competitor& integer, double share);

/// What a fit says about its orders.
struct Orders {
  bool any_free = false;
  const ParameterEstimate* decided = nullptr;  // the one farthest (in intervals) from every whole number
  /// Squared standard errors, widened as much as the share asks for, from the estimate to the nearest order that
  /// departs() and to where what is fractional shows, whichever is farther; 0 where an order does both already.
  double departure = std::numeric_limits<double>::infinity();
  bool all_nearly_whole = true;  // each known to be within 0.02 of one, which may lie outside the interval
  bool any_departs = false;      // or is not known; so are those that are written as numbers
};
[[nodiscard]] Orders orders_of(const Competitor& competitor, double share);

/// Evidence of the best candidate with an order that departs() against the integer-order finalist.
struct Departure {
  double evidence = -std::numeric_limits<double>::infinity();
  std::size_t parameters = 0;
};
[[nodiscard]] Departure evidence_of_departure(const std::vector<Competitor>& competitors, const Competitor& integer,
                                              double share);

/// What a candidate leaves of the data.
/// @param per_point  residuals of a point
[[nodiscard]] Leftover leftover_of(const Competitor& competitor, std::size_t per_point);

/// Evidence where the data may hold a smooth error of usual size beside their noise: of the best fractional candidate
/// against the best one of integer order, all by evidence_against() the candidate that comes closest.  What follows a
/// smooth error no longer pays for its parameters then.  NaN where a class has no candidate.
struct EvidenceBesideSmoothError {
  double fractional;  // of any fractional candidate
  double departing;   // of one with an order that departs()
};
[[nodiscard]] EvidenceBesideSmoothError evidence_beside_smooth_error(const std::vector<Competitor>& competitors,
                                                                     std::size_t per_point);

}  // namespace frac::detail
