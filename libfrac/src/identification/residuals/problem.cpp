// SPDX-License-Identifier: BSD-3-Clause
#include "problem.hpp"

#include <algorithm>
#include <limits>

#include "frac/identification/constraints.hpp"

namespace frac::detail {
namespace {

std::vector<ParameterConstraint> without_limits(const Structure& structure) {
  std::vector<ParameterConstraint> constraints;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] == ParameterRole::coefficient)
      constraints.push_back({structure.parameter_names()[i], {}, -std::numeric_limits<double>::infinity(), {}, {}});
  }
  return constraints;
}

}  // namespace

std::vector<ParameterConstraint> with_longest_delay(const Structure& structure,
                                                    std::vector<ParameterConstraint> constraints, double longest) {
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] != ParameterRole::delay) continue;
    ParameterConstraint& known = constraint_of(constraints, structure.parameter_names()[i]);
    if (!known.fixed && !known.upper && !(known.lower > longest))
      known.upper = std::max(longest, 2 * known.start.value_or(0));
  }
  return constraints;
}

// In units of 1 and 1 rad/s variables of either sign are the parameters.
Problem::Problem(const Structure& model, ByParameters)
    : Problem(model, without_limits(model), {1, 1, 1, 1, 1, 1}, false) {}

}  // namespace frac::detail
