// SPDX-License-Identifier: BSD-3-Clause
#include "io/shard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace {

double longest_over_mean(const std::vector<double>& cost, std::size_t count) {
  const auto owner = io::shards_of(cost, count);
  std::vector<double> load(count);
  for (std::size_t i = 0; i < cost.size(); ++i) load.at(owner[i] - 1) += cost[i];
  return *std::ranges::max_element(load) * static_cast<double>(count) / std::accumulate(cost.begin(), cost.end(), 0.0);
}

TEST(Shard, EachPieceBelongsToOneShardInItsOrder) {
  const std::vector<double> cost{5, 1, 1, 7, 2, 2, 9, 3};
  std::vector<std::size_t> all(cost.size()), found;
  std::iota(all.begin(), all.end(), std::size_t{0});
  for (std::size_t index = 1; index <= 3; ++index) {
    const auto part = io::part_of(all, io::Shard{index, 3}, cost);
    EXPECT_TRUE(std::ranges::is_sorted(part));
    found.insert(found.end(), part.begin(), part.end());
  }
  std::ranges::sort(found);
  EXPECT_EQ(found, all);
  EXPECT_TRUE(io::part_of(all, io::Shard{9, 9}, cost).empty());
}

TEST(Shard, PiecesOfEqualCostGoRound) {
  EXPECT_EQ(io::shards_of({1, 1, 1, 1, 1}, 2), (std::vector<std::size_t>{1, 2, 1, 2, 1}));
  EXPECT_EQ(io::part_of(5, {2, 2}), (std::vector<std::size_t>{1, 3}));
  EXPECT_TRUE(io::part_of(5, {9, 9}).empty());
}

// Of loads that the costliest pieces fill first, none exceeds the mean by more than the last piece it took, and while
// there are cheap pieces left that is a cheap one.
TEST(Shard, TheLongestIsLongerThanTheMeanByACheapPieceAtMost) {
  std::vector<double> cost;
  for (int i = 0; i < 1000; ++i) cost.push_back(1 + 1 / (1.006 - i / 999.0));
  const double cheapest = cost.front(), mean = std::accumulate(cost.begin(), cost.end(), 0.0) / 8;
  EXPECT_LE(longest_over_mean(cost, 8), 1 + 1.1 * cheapest / mean);
}

}  // namespace
