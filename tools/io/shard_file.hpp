// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace io {

/// True where the file begins like the CSV of a map or a sweep, whose rows stand in blocks: one per restitution or
/// scene, told by the columns before the frequency.
[[nodiscard]] bool is_block_table(const std::string& file);

/// The text of the whole table from its shards, given in any order: as if it had been computed in one piece.
/// @throws DataError  a file is no such shard, stems from another command or version than the first one, or a shard is
///                    missing or given twice.
[[nodiscard]] std::string joined_block_table(const std::vector<std::string>& files);

}  // namespace io
