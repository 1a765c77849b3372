// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/regime_map.hpp"
#include "io/shard.hpp"

namespace io {

/// CSV text of a map: header lines with version, command and scene, the shard where there is more than one, then
/// restitution and the columns of a point with diagnostics, restitution slowest; a shard ends with its checksum.
[[nodiscard]] std::string map_csv(const backlash::RegimeMap& map, const std::string& command, const Shard& shard);

}  // namespace io
