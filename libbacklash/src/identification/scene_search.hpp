// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// -2 ln of odds of 150 to 1, up to which another scene is a rival.
constexpr double rival_deviance = 10;
/// Of a place worth an estimate, -2 ln of odds against the best one at most.
constexpr double worth_settling = 100;

/// Estimates that agree to this are one.
constexpr double same_estimate = 1e-4;

struct SceneSearch {
  /// The estimate of greatest evidence; not usable when no start was.
  LocalScene best;
  /// Other estimates of which the best one has odds that are not beyond doubt, best first.
  std::vector<LocalScene> rivals;
  std::size_t starts = 0;
  std::size_t starts_at_best = 0;
};

/// Follows places to the estimates of a family, and keeps the best.
class SceneSearcher {
 public:
  /// @param family  stays with the caller
  SceneSearcher(const SceneFamily& family, int threads) : family_(family), threads_(threads) {}

  /// Places looked at so far.
  [[nodiscard]] std::size_t starts() const { return tried_; }

  /// Estimates from starts, best first, without those that are not usable.
  [[nodiscard]] std::vector<LocalScene> solve(const std::vector<Coordinates>& starts, Effort effort,
                                              Motions motions) const;
  /// The best places that are not near each other.
  /// @param sorted  best first
  /// @param worth   most by which the deviance may be above that of the best
  [[nodiscard]] std::vector<Coordinates> places_of(const std::vector<LocalScene>& sorted, std::size_t most,
                                                   double worth = std::numeric_limits<double>::infinity()) const;

  /// Looks at starts, from whose best places settle() goes on.
  void glance(const std::vector<Coordinates>& starts);
  /// The best places seen so far, each followed to its estimate, best first.
  [[nodiscard]] std::vector<LocalScene> settle();
  /// Estimates from more starts, best first; those beside an estimate that is there already lead back to it.
  void settle_too(const std::vector<Coordinates>& starts, std::vector<LocalScene>& settled);

  /// Lets simulations tell what the best estimates do at points that they leave out, which may put another one first.
  void explain(std::vector<LocalScene>& settled) const;
  /// @param settled  best first
  /// @param allowed  deviance of rivals above that of the best
  [[nodiscard]] SceneSearch best_of(const std::vector<LocalScene>& settled, double allowed) const;

 private:
  const SceneFamily& family_;
  int threads_;
  std::vector<LocalScene> glances_;
  std::size_t tried_ = 0;
};

/// Every point lies on its motion, and what is left of them is noise.
[[nodiscard]] bool is_complete(const SceneFamily& family, const LocalScene& local);

}  // namespace backlash::detail
