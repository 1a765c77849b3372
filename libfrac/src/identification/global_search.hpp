#pragma once

#include <cstdint>
#include <vector>

#include "local_solve.hpp"

namespace frac::detail {

struct GlobalSolution {
  LocalSolution best;
  std::size_t starts = 0;          // local solves made
  std::size_t starts_at_best = 0;  // of which ended at the best cost
};

/// Local slopes d ln|G|/d ln omega at the lower end, the upper end and the extremes: orders the data suggest.
[[nodiscard]] std::vector<double> suggested_orders(const FrequencyResponseData& data);

/// Seeded multi-start: each round draws coefficients from the magnitudes and frequencies the data span (their dimension
/// says how), orders from the suggested ones and from their ranges, keeps the few draws of lowest cost and solves from
/// each.  It ends when three solves agree on the best cost; if they never do, NLopt's controlled random search tries
/// the whole box. starts_at_best is 0 when the model is finite nowhere it was tried.
[[nodiscard]] GlobalSolution global_search(const Residuals& residuals, const std::vector<double>& suggested_orders,
                                           std::uint64_t seed);

}  // namespace frac::detail
