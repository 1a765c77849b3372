// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "backlash/loops/cycle_continuation.hpp"

namespace backlash::detail {

/// Cycles that are no symmetric ones of two impacts, followed over the values.
class CycleBranches {
 public:
  /// @param parameters  two or more, rising or falling
  CycleBranches(const std::function<ControlLoop(double)>& loop_at, const std::vector<double>& parameters);

  /// @param breaking  a symmetry breaking of a symmetric cycle that is a motion
  void add_from(const CycleEvent& breaking);
  /// A cycle that is a stable motion, to both sides of where it was found.
  void add_found(const ImpactCycle& cycle, double parameter);
  /// One with rests, of which Newton's method knows no next one: beside its like at the value that was looked at
  /// before, it is one with that.
  /// @param before  NaN at the first value
  void add_resting(const ImpactCycle& cycle, double parameter, double before);

  std::vector<CycleBranch> found;

 private:
  void add(CycleBranch branch);
  [[nodiscard]] std::optional<ImpactCycle> born_at(double parameter, double omega) const;
  // @param longest  first step, from which steps may double: right beyond a fold the other side of it is near
  void follow(CycleBranch& branch, const CycleBranch::Sample& first, bool rises,
              double longest = std::numeric_limits<double>::infinity());
  [[nodiscard]] std::optional<ImpactCycle> near(const ImpactCycle& cycle, double parameter, bool judges) const;
  // Where a branch that was followed to the last of three samples, and no further, turns back: the fold, and a cycle
  // beyond it.
  void turn_back(CycleBranch& branch, const std::vector<CycleBranch::Sample>& last, bool rises);
  // Finds events, and where the cycle is a motion and stable.
  void look_between(CycleBranch& branch, const CycleBranch::Sample& a, const CycleBranch::Sample& b) const;

  const std::function<ControlLoop(double)>& loop_at_;
  std::vector<double> parameters_;   // rising
  double step_;                      // between them, the least
  std::vector<CycleBranch> turned_;  // back at a fold of the branch that is being followed
  std::size_t turns_ = 0;
};

/// Adds an interval, its ends in any order, to rising ones; those that touch become one.
void add_interval(std::vector<ParameterInterval>& intervals, double from, double to);
/// The parts of rising intervals outside of others.
[[nodiscard]] std::vector<ParameterInterval> without(const std::vector<ParameterInterval>& intervals,
                                                     const std::vector<ParameterInterval>& others);

}  // namespace backlash::detail
