// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <stdexcept>

#include "identification/residuals/parameter_map.hpp"

namespace frac::detail {

/// @throws std::invalid_argument  a free parameter has none
inline void require_start_values(const ParameterMap& map, const Structure& structure) {
  for (const auto& entry : map.free()) {
    if (std::isnan(map.start()[entry.parameter])) {
      throw std::invalid_argument("parameter '" + structure.parameter_names()[entry.parameter] +
                                  "' has no start value, and the search for one is switched off");
    }
  }
}

}  // namespace frac::detail
