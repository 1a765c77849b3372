// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/identification/economy.hpp"
#include "output/json.hpp"

namespace fracfit {

/// Tables for people: parameters needed, error against number of parameters, the sentence.
[[nodiscard]] std::string economy_table(const frac::Economy& economy);

[[nodiscard]] Json economy_json(const frac::Economy& economy);

}  // namespace fracfit
