// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "frac/identification/model_library.hpp"

namespace frac::detail {

/// What a family came to on given data, simplest member first, as formulas with start values.
struct FamilyMembers {
  std::vector<NamedModel> models;
  std::size_t chosen = 0;  // by BIC and the price of the search
};

/// @param model  with a family
/// @throws std::invalid_argument  as resolved_model()
[[nodiscard]] FamilyMembers family_members(const FrequencyResponseData& data, const NamedModel& model,
                                           const FitOptions& options);

/// What the best ratio of the default family gives at the frequencies of the data; empty where there is none.
[[nodiscard]] std::vector<std::complex<double>> ratio_response(const FrequencyResponseData& data,
                                                               const FitOptions& options);

[[nodiscard]] NamedModel best_member(const FrequencyResponseData& data, const NamedModel& model,
                                     const FitOptions& options);

}  // namespace frac::detail
