// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "expression.hpp"

namespace frac::detail {

/// Reads a formula by the grammar of frac::Structure.
/// @throws FormulaError
[[nodiscard]] Expression parse_formula(std::string_view formula);

}  // namespace frac::detail
