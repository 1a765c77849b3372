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

}  // namespace frac::detail
