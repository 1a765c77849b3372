// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "departures.hpp"
#include "fitted_points.hpp"
#include "frac/identification/validate.hpp"

namespace frac::detail {

/// A model of the points that do not stand out, and what was found on the way.
struct Judgement {
  Fitted fitted;
  Tested first, last;  // with all points, and without those that stand out
  std::vector<ValidityTest> of_points;
  std::vector<std::size_t> outliers, mains;
  double left_of_mirrored = 0;  // with poles on a grid, of all points

  [[nodiscard]] bool pattern(double level) const {
    return std::any_of(all_tests.begin(), all_tests.end(),
                       [&](ValidityTest test) { return !is_of_points(test) && last.alarm(test, level); });
  }
  [[nodiscard]] bool steady(double level) const { return !pattern(level) && of_points.empty(); }
};

/// The model that explains all points best, and what they show beside it.
[[nodiscard]] Judgement judge(const FrequencyResponseData& data, const ValidationOptions& options);

/// AICc of all points with the part of the likelihood that depends on the weights.  A point set aside costs
/// price_of_point; a drift two parameters, its size and its law; a step two, its size and place.
[[nodiscard]] double criterion_of_all(const FrequencyResponseData& data, const Judgement& judgement);

}  // namespace frac::detail
