// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// Part of a list of pieces of work.
struct Shard {
  std::size_t index = 1;  // 1 .. count
  std::size_t count = 1;  // 1: all
};

/// Name of the header entry that tells the shard of a file.
inline constexpr std::string_view shard_key = "shard";

/// "i/n".
[[nodiscard]] inline std::string text_of(const Shard& shard) {
  return std::to_string(shard.index) + "/" + std::to_string(shard.count);
}

/// The shard of a text "i/n"; empty where it is none with 1 <= i <= n.
[[nodiscard]] std::optional<Shard> shard_from(std::string_view text);

/// The shard that a batch system or a launcher has given this process: its number in an array of tasks (Slurm, SGE,
/// PBS, Kubernetes), its rank among the processes started together (Open MPI, PMI, PMIx, srun), or both.
/// @param count  number of all shards; 0 where the environment tells it
/// @throws std::invalid_argument  no such variable is set, the number of shards cannot be told, or does not fit.
[[nodiscard]] Shard shard_of_environment(std::size_t count);

/// The path with "{shard}" replaced by "03-of-12", so that names sort as numbers do.
[[nodiscard]] std::string with_shard(std::string path, const Shard& shard);

/// "1,4-7,9" of rising numbers, as sbatch --array= takes it.
[[nodiscard]] std::string list_of(const std::vector<std::size_t>& numbers);

/// The shard, from 1, of each piece: the costliest first, each goes to the shard that has least to do so far, so that
/// shards differ by little more than one cheap piece.  Pieces of equal cost go round.
/// @param cost   of each piece, > 0
/// @param count  number of shards
[[nodiscard]] std::vector<std::size_t> shards_of(const std::vector<double>& cost, std::size_t count);

/// The pieces of a shard, in their order.
/// @param cost  of each of all pieces
template <typename Piece>
[[nodiscard]] std::vector<Piece> part_of(const std::vector<Piece>& all, const Shard& shard,
                                         const std::vector<double>& cost) {
  const std::vector<std::size_t> owner = shards_of(cost, shard.count);
  std::vector<Piece> part;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (owner[i] == shard.index) part.push_back(all[i]);
  return part;
}
/// Places, from 0, of a shard's pieces where all have equal cost.
[[nodiscard]] std::vector<std::size_t> part_of(std::size_t pieces, const Shard& shard);

}  // namespace io
