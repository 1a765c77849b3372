// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "backlash/orbit_continuation.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// One row per orbit and bifurcation, in "csv" or "table".
/// @param contact  entries of contacts that take time, none with a restitution
[[nodiscard]] std::string orbits_text(const backlash::OrbitDiagram& diagram, const io::Metadata& contact,
                                      const std::string& format, const std::string& command);
/// The impacts of each orbit too.
[[nodiscard]] std::string orbits_json(const backlash::OrbitDiagram& diagram, const io::Metadata& contact,
                                      const std::string& command);

}  // namespace fracfit
