// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/constraints.hpp"

#include <algorithm>
#include <string>

namespace frac {

ParameterConstraint& constraint_of(std::vector<ParameterConstraint>& constraints, std::string_view name) {
  const auto found = std::find_if(constraints.begin(), constraints.end(),
                                  [&](const ParameterConstraint& each) { return each.name == name; });
  return found != constraints.end() ? *found
                                    : constraints.emplace_back(ParameterConstraint{std::string(name), {}, {}, {}, {}});
}

}  // namespace frac
