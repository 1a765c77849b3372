#pragma once

#include <string>
#include <vector>

#include "backlash/regime_map.hpp"
#include "io/shard.hpp"

namespace io {

/// CSV text of a map: header lines with version, command and scene, the shard where there is more than one, then
/// restitution and the columns of a point with diagnostics, restitution slowest.
[[nodiscard]] std::string map_csv(const backlash::RegimeMap& map, const std::string& command, const Shard& shard);

/// True where the file begins like one that map_csv wrote.
[[nodiscard]] bool is_map_file(const std::string& file);

/// The text of the whole map from its shards, given in any order: as if it had been computed in one piece.
/// @throws DataError  a file is no shard of a map, stems from another command or version than the first one, or a shard
///                    is missing or given twice.
[[nodiscard]] std::string joined_map_csv(const std::vector<std::string>& files);

}  // namespace io
