// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "expression.hpp"

namespace frac::detail {

/// The same formula with the factors cosh z of divisors, and whole powers of it, as factors sech z of the dividend,
/// which no z makes overflow.
[[nodiscard]] Expression with_bounded_reciprocals(const Expression& expression);

}  // namespace frac::detail
