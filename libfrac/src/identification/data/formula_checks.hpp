// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/structure.hpp"

namespace frac::detail {

/// Refuses formulas whose frequency is hidden in parameters: letters that stand for frequency elsewhere (j, i, w,
/// omega, p, S, x, z) would be fitted as numbers, and so would the orders of powers without s.  Products of parameters
/// without s are one constant: a misspelt name of a preset, mostly.
/// @throws std::invalid_argument  with what to write instead.
void require_function_of_s(const Structure& structure);

}  // namespace frac::detail
