// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/fit.hpp"

namespace frac {

/// fit() several times sooner, where similar data, such as the spectrum measured before, have been fitted with that
/// structure and these options: one solve from there.  The search is made as by fit() unless that solve follows the data
/// to within noise, as the similar answer did, and pins every parameter down to 10 %; and for robust losses.
/// @throws std::invalid_argument  as fit().
[[nodiscard]] FitResult fit_from(const FitResult& similar, const FrequencyResponseData& data,
                                 const Structure& structure, const FitOptions& options);

}  // namespace frac
