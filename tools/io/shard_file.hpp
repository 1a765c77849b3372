// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace io {

/// Last line of a shard, "# checksum: " with the fingerprint of all text above it.
[[nodiscard]] std::string checksum_line(std::string_view text);

/// True where the file begins like the CSV of a map or a sweep, whose rows stand in blocks: one per restitution or
/// scene, told by the columns before the frequency.
/// @throws DataError  it cannot be read.
[[nodiscard]] bool is_block_table(const std::string& file);

/// The text of the whole table from its shards, given in any order: as if it had been computed in one piece.
/// @throws DataError  a file is no such shard; its rows are not those of the grid in its command, or hold what is no
///                    number; its content does not have its checksum; it stems from another command or version than
///                    the first one; or a shard is missing or given twice.  The text names file and line.
[[nodiscard]] std::string joined_block_table(const std::vector<std::string>& files);

}  // namespace io
