// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Whether enough residuals are left over to judge a candidate by.  With more parameters than half of them a model may
/// pass through every point, for which no price is high enough.
[[nodiscard]] bool is_comparable(const Competitor& competitor);

/// Whether all residuals are rounding, which have no correlation.
[[nodiscard]] bool meets_exactly(const Competitor& competitor);

/// n ln(cost/n), or what stands for it under noise with heavy tails where that explains the residuals better.  A model
/// is not refuted by a few points that another one goes out of its way for.
[[nodiscard]] double misfit_term(const Competitor& competitor);

/// What finalists are chosen by, least first: misfit_term() and the price of the parameters.
[[nodiscard]] double criterion(const Competitor& competitor);

/// The best candidate of each class, among those that follow the data to within their noise; where a class has none,
/// among all that are comparable.  Empty where there is none of these either.
struct Finalists {
  std::optional<std::size_t> fractional, integer;  // indices of competitors
  bool fractional_follows = false, integer_follows = false;
};
[[nodiscard]] Finalists finalists_of(const std::vector<Competitor>& competitors);

}  // namespace frac::detail
