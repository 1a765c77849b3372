// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/identification/model_library.hpp"
#include "rational_growth.hpp"

namespace frac::detail {

/// The fit as a formula with start values; its name is "rational:ZEROS/POLES", with "+delay" where it has one.
/// @param component  of the residuals: where it is blind to a constant, that stands apart in the formula
[[nodiscard]] NamedModel written_out(const RationalProblem& problem, const RationalShape& shape, Component component);

/// The ladder of a family, simplest member first.
/// @throws std::invalid_argument  as resolved_model()
struct RationalMembers {
  std::vector<NamedModel> models;
  std::size_t chosen = 0;  // by BIC
};
[[nodiscard]] RationalMembers rational_members(const FrequencyResponseData& data, const RationalFamily& family,
                                               const FitOptions& options);

[[nodiscard]] NamedModel best_rational_model(const FrequencyResponseData& data, const RationalFamily& family,
                                             const FitOptions& options);

}  // namespace frac::detail
