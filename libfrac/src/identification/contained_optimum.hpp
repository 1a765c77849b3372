// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// A preset that contains a simpler one.
struct Containment {
  std::string_view rich, simple;
};
/// All of the library, simpler ones first.
[[nodiscard]] std::vector<Containment> containments();

/// Start values with which the richer preset is the simpler one at its optimum, or next to it where it is a limit.
/// @param fit  of the simpler one
/// @param gain_of_data  beside which a millionth is little
[[nodiscard]] std::vector<ParameterConstraint> start_of_contained(const Containment& pair, const FitResult& fit,
                                                                  double gain_of_data);

}  // namespace frac::detail
