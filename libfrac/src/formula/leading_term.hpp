// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "expression.hpp"
#include "frac/power_term.hpp"

namespace frac::detail {

enum class Limit { origin, infinity };

/// The multiple of a power that a formula tends to along the positive axis; of infinite order where it vanishes or
/// grows as an exponential does.  Empty where leading terms cancel, where a logarithm leads, and where a value is not
/// real.
[[nodiscard]] std::optional<PowerTerm> leading_term(const Expression& expression, std::span<const double> parameters,
                                                    Limit limit);

}  // namespace frac::detail
