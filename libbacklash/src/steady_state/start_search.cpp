// SPDX-License-Identifier: BSD-3-Clause
#include "start_search.hpp"

#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>

#include "base/check.hpp"

namespace backlash::detail {
namespace {

class MemoryStore : public OutcomeStore {
 public:
  [[nodiscard]] bool contains(const std::string& key) const override {
    const std::lock_guard guard(mutex_);
    return kept_.contains(key);
  }
  [[nodiscard]] std::vector<StartOutcome> outcomes(const std::string& key) const override {
    const std::lock_guard guard(mutex_);
    return kept_.at(key);
  }
  void keep(const std::string& key, const std::vector<StartOutcome>& outcomes) override {
    const std::lock_guard guard(mutex_);
    kept_.emplace(key, outcomes);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<StartOutcome>> kept_;
};

}  // namespace

void require_starts(const TwoMassSystem& system, const std::vector<double>& position,
                    const std::vector<double>& velocity) {
  require_positive("clearance", "m", system.clearance());
  if (position.empty()) throw std::invalid_argument("position is empty; it must hold at least one value");
  if (velocity.empty()) throw std::invalid_argument("velocity is empty; it must hold at least one value");
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (!(position[i] >= 0 && position[i] <= system.clearance())) {
      throw std::invalid_argument("position[" + std::to_string(i) + "] is " + text(position[i]) +
                                  "; it must be in [0, clearance = " + text(system.clearance()) + "] (m)");
    }
  }
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (!std::isfinite(velocity[i])) {
      throw std::invalid_argument("velocity[" + std::to_string(i) + "] is " + text(velocity[i]) +
                                  "; it must be finite (m/s)");
    }
  }
}

BasinMap in_memory(const std::function<BasinMap(OutcomeStore&)>& search) {
  MemoryStore store;
  return search(store);
}

void StartSearch::follow(const std::function<StartOutcome(std::size_t)>& course, frac::Progress* progress) {
  if (progress != nullptr) progress->total += starts_;
  frac::parallel_for((starts_ + per_piece - 1) / per_piece, threads_, [&](std::size_t piece) {
    const std::size_t first = piece * per_piece, last = std::min(starts_, first + per_piece);
    const bool is_there = store_.contains(key_of(piece));
    std::vector<StartOutcome> outcomes;
    for (std::size_t i = first; i < last; ++i) {
      if (!is_there) outcomes.push_back(course(i));
      if (progress != nullptr) ++progress->done;
    }
    if (!is_there) store_.keep(key_of(piece), outcomes);
  });
}

}  // namespace backlash::detail
