// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/fingerprint.hpp"
#include "io/output_file.hpp"
#include "io/shard.hpp"

namespace io {

/// Last line of a shard, "# checksum: " with the fingerprint of all text above it.
[[nodiscard]] std::string checksum_line(const Fingerprint& text);

/// First line of a table that is not finished yet.
inline constexpr std::string_view unfinished_line = "# unfinished: the same command again goes on with what is left";

/// True where the file begins like the CSV of a map or a sweep, whose rows stand in blocks: one per restitution or
/// scene, told by the columns before the frequency.
/// @throws DataError  it cannot be read.
[[nodiscard]] bool is_block_table(const std::string& file);

/// Writes the whole table from its shards, given in any order, as if it had been computed in one piece.  Rows are
/// copied from file to file, so that memory does not grow with them.
/// @throws DataError  a file is no such shard, or is unfinished; its rows are not those of the grid in its command, or
///                    hold what is no number; its content does not have its checksum; it stems from another command or
///                    version than the first one; or shards are missing or given twice.  The text names file and line,
///                    and the missing shards as sbatch --array= takes them.
void join_block_tables(const std::vector<std::string>& files, const OutputFile::Sink& sink);

/// @throws DataError  a file is one of another number of shards than the first file.
void require_shard_count(std::size_t of_first, std::size_t count, const std::string& first, const std::string& file);

/// How far a shard is.
struct ShardState {
  std::string file;
  Shard shard;
  std::size_t rows = 0;      // that are there
  std::size_t expected = 0;  // of the finished shard
  std::string fault;         // why it cannot be joined; empty: it can
};

/// State of each file, every row read and checked.
/// @throws DataError  the files stem from different commands, or one is no shard at all.
[[nodiscard]] std::vector<ShardState> shard_states(const std::vector<std::string>& files);

}  // namespace io
