// SPDX-License-Identifier: BSD-3-Clause
#include "problem.hpp"

#include <limits>

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

// In units of 1 and 1 rad/s variables of either sign are the parameters.
Problem::Problem(const Structure& model, ByParameters)
    : Problem(model, without_limits(model), {1, 1, 1, 1, 1, 1}, false) {}

}  // namespace frac::detail
