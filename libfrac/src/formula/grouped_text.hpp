// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "expression.hpp"

namespace frac::detail {

/// A formula that parses to the same expression and leaves no doubt what belongs together: a quotient within a product
/// or a quotient, and the base and the exponent of a power that are more than one name, stand in parentheses.
[[nodiscard]] std::string grouped_text(const Expression& expression);

}  // namespace frac::detail
