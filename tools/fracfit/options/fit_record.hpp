// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"

namespace fracfit {

/// A fit as its JSON tells it: model, parameters with standard errors and covariance, numbers of residuals and of free
/// parameters.  Of the other members of a FitResult nothing is known.
/// @throws io::DataError  unreadable, no JSON, or not written by fracfit fit.
[[nodiscard]] frac::FitResult read_fit(const std::string& file);

/// Where the JSON of an identification asks for the next measurement.
/// @throws io::DataError  unreadable, no JSON, not written by fracfit identify, or it asks for none.
[[nodiscard]] frac::NextMeasurement read_next_measurement(const std::string& file);

}  // namespace fracfit
