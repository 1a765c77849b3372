// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace io {

/// Part of a list of pieces of work: those from index - 1 on in steps of count.
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

template <typename Piece>
[[nodiscard]] std::vector<Piece> part_of(const std::vector<Piece>& all, const Shard& shard) {
  std::vector<Piece> part;
  for (std::size_t i = shard.index - 1; i < all.size(); i += shard.count) part.push_back(all[i]);
  return part;
}

}  // namespace io
