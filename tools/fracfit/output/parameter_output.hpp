// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/derived.hpp"
#include "frac/identification/fit.hpp"
#include "output/json.hpp"

namespace fracfit {

// What outputs of fits of every kind say alike of a parameter.

/// "lower .. upper".
[[nodiscard]] std::string interval(double lower, double upper);
/// Why it has no interval worth the name; empty where it has one.
[[nodiscard]] std::string parameter_state(const frac::ParameterEstimate& parameter);
[[nodiscard]] Json parameter_json(const frac::ParameterEstimate& parameter);

[[nodiscard]] Json derived_json(const std::vector<frac::DerivedEstimate>& derived);
/// One line each, below the name of the table; empty where there are none.
[[nodiscard]] std::string derived_table(const std::vector<frac::DerivedEstimate>& derived);

}  // namespace fracfit
