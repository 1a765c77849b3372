// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "backlash/orbit_continuation.hpp"

namespace fracfit {

[[nodiscard]] std::string orbits_csv(const backlash::OrbitDiagram& diagram, const std::string& command);
/// A number that is not finite is written as null.
[[nodiscard]] std::string orbits_json(const backlash::OrbitDiagram& diagram, const std::string& command);

}  // namespace fracfit
