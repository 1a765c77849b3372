// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "backlash/basins.hpp"
#include "frac/parallel_for.hpp"

namespace backlash::detail {

/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed.
void require_starts(const TwoMassSystem& system, const std::vector<double>& position,
                    const std::vector<double>& velocity);

/// basins() with outcomes in memory. @param search  the same with a store
[[nodiscard]] BasinMap in_memory(const std::function<BasinMap(OutcomeStore&)>& search);

/// Starts whose outcomes stand in a store.
class StartSearch {
 public:
  StartSearch(std::size_t starts, int threads, OutcomeStore& store)
      : starts_(starts), threads_(threads), store_(store) {}

  /// Follows the starts that are not in the store.
  /// @param course  of a start
  void follow(const std::function<StartOutcome(std::size_t)>& course, frac::Progress* progress);
  /// Hands over the outcome of each start, in their order.
  template <class Take>
  void for_each_outcome(const Take& take) const {
    for (std::size_t piece = 0; piece * per_piece < starts_; ++piece) {
      const std::vector<StartOutcome> outcomes = store_.outcomes(key_of(piece));
      for (std::size_t i = 0; i < outcomes.size(); ++i) take(piece * per_piece + i, outcomes[i]);
    }
  }

 protected:
  [[nodiscard]] StartOutcome outcome(std::size_t start) const {
    return store_.outcomes(key_of(start / per_piece)).at(start % per_piece);
  }
  [[nodiscard]] std::size_t starts() const noexcept { return starts_; }
  [[nodiscard]] int threads() const noexcept { return threads_; }
  [[nodiscard]] OutcomeStore& store() const noexcept { return store_; }

 private:
  // Starts that are kept together: milliseconds of work.
  static constexpr std::size_t per_piece = 16;
  static std::string key_of(std::size_t piece) { return std::to_string(piece); }

  std::size_t starts_;
  int threads_;
  OutcomeStore& store_;
};

/// Long-run motions, each once, that starts lead to one after the other.
/// @tparam Same  whether two motions are one
template <class Motion, class Same>
class MotionsOfStarts {
 public:
  explicit MotionsOfStarts(Same same) : same_(std::move(same)) {}

  void add(const Motion& motion) {
    const auto known =
        std::find_if(first_.begin(), first_.end(), [&](const Motion& other) { return same_(motion, other); });
    const auto index = static_cast<std::size_t>(known - first_.begin());
    if (known == first_.end()) {
      first_.push_back(motion);
      count_.push_back(0);
    }
    ++count_[index];
    of_start_.push_back(index);
  }
  /// Of many starts first. @param attractor  from a motion and its number of starts
  template <class Describe>
  void write(BasinMap& map, const Describe& attractor) const {
    std::vector<std::size_t> order(first_.size()), rank(first_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return count_[a] > count_[b]; });
    for (std::size_t i = 0; i < order.size(); ++i) {
      rank[order[i]] = i;
      map.attractors.push_back(attractor(first_[order[i]], count_[order[i]]));
    }
    for (const std::size_t index : of_start_) map.attractor.push_back(rank[index]);
  }

 private:
  Same same_;
  std::vector<Motion> first_;
  std::vector<std::size_t> count_, of_start_;
};

}  // namespace backlash::detail
