// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>

#include "identification/residuals/parameter_map.hpp"

namespace frac::detail {

/// The first free parameter without a start value.
[[nodiscard]] inline std::optional<std::size_t> without_start(const ParameterMap& map) {
  for (const auto& entry : map.free())
    if (std::isnan(map.start()[entry.parameter])) return entry.parameter;
  return std::nullopt;
}

/// @throws std::invalid_argument  a free parameter has none
inline void require_start_values(const ParameterMap& map, const Structure& structure) {
  if (const auto parameter = without_start(map)) {
    throw std::invalid_argument("parameter '" + structure.parameter_names()[*parameter] +
                                "' has no start value, and the search for one is switched off");
  }
}

}  // namespace frac::detail
