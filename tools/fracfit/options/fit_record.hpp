// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/identification/fit.hpp"

namespace fracfit {

/// A fit as its JSON tells it: model, parameters with standard errors and covariance, numbers of residuals and of free
/// parameters.  Of the other members of a FitResult nothing is known.
/// @throws io::DataError  unreadable, no JSON, or not written by fracfit fit.
[[nodiscard]] frac::FitResult read_fit(const std::string& file);

}  // namespace fracfit
