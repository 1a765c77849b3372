// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "expression.hpp"
#include "frac/structure.hpp"

namespace frac::detail {

/// What the parameters of an expression do, by parameter index.
struct ParameterUse {
  std::vector<ParameterRole> roles;
  std::vector<bool> in_sum;
  std::vector<bool> keeps_sign;
};

[[nodiscard]] ParameterUse parameter_use(const Expression& expression);

/// For each parameter whether it is nothing but the order q of terms c s^q of the outermost sum, as a2 is in
/// R0 + K1 s^a1 + K2 s^a2: there s^-1 is a response like any other.
[[nodiscard]] std::vector<bool> orders_of_plain_powers(const Expression& expression);

}  // namespace frac::detail
