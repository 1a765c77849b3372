// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "frac/identification/economy.hpp"
#include "frac/identification/model_library.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/rational/projection.hpp"
#include "identification/search/thinned.hpp"

namespace frac::detail {

/// Data with the rule of relative residuals of one component or of both.
struct EconomyProblem {
  const FrequencyResponseData& data;
  ResidualRule rule;
  EconomyOptions options;  // most_parameters as far as the data tell that many
};

/// Errors below it are rounding: ProjectedData ends a search at residuals of 1e-14, and terms that cancel each other to
/// a hundredth leave a hundred times that.
inline constexpr double economy_rounding = 1e-12;

inline constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two orders nearer than that are one.
inline constexpr double same_order = 1e-6;
[[nodiscard]] inline bool is_whole(double order) {
  return std::abs(order - std::round(order)) < same_order;
}

/// rms over the points for a sum of squared residuals.
[[nodiscard]] inline double economy_error(const EconomyProblem& problem, double cost) {
  return std::sqrt(cost / static_cast<double>(problem.data.size()));
}

/// Fewer points, each with the weight of those it is nearest to: costs are estimates of those of all points.
[[nodiscard]] Thinned scouted(const EconomyProblem& problem, std::size_t points);

/// Searches end where a step promises less than 1e-9 of the cost.
inline constexpr Effort to_the_end{200, 1e-9};

[[nodiscard]] EconomyCurve economy_of_real_powers(const EconomyProblem& problem);
[[nodiscard]] EconomyCurve economy_of_integer_powers(const EconomyProblem& problem, EconomyClass model_class);
/// @param model_class  rational or commensurate
[[nodiscard]] EconomyCurve economy_of_ratios(const EconomyProblem& problem, EconomyClass model_class);
[[nodiscard]] EconomyCurve economy_of_terms(const EconomyProblem& problem);

/// Appends the point if it is better than all before.
void add_point(EconomyCurve& curve, EconomyPoint point);

/// The formula with the start values of its parameters in their places.
[[nodiscard]] std::string with_numbers(const NamedModel& model);
/// A coefficient as the first or a further term of a sum: "2.5", " + 2.5", " - 2.5".
[[nodiscard]] std::string signed_number(double value, bool first);

}  // namespace frac::detail
