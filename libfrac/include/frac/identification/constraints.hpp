// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"

namespace frac {

/// The constraint on a parameter, to be changed; where the list has none, one without limits is added at its end.
/// Valid until the list grows again.
[[nodiscard]] ParameterConstraint& constraint_of(std::vector<ParameterConstraint>& constraints, std::string_view name);

}  // namespace frac
