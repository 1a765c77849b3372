// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/identification/fit.hpp"
#include "output/json.hpp"

namespace fracfit {

// What outputs of fits of every kind say alike of a parameter.

/// "lower .. upper".
[[nodiscard]] std::string interval(double lower, double upper);
/// Why it has no interval worth the name; empty where it has one.
[[nodiscard]] std::string parameter_state(const frac::ParameterEstimate& parameter);
[[nodiscard]] Json parameter_json(const frac::ParameterEstimate& parameter);

}  // namespace fracfit
