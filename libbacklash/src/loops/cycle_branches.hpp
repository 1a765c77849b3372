// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "backlash/loops/cycle_continuation.hpp"

namespace backlash::detail {

/// The asymmetric cycles that begin where symmetric ones break their symmetry, followed over the values on their side.
class CycleBranches {
 public:
  /// @param parameters  two or more, rising or falling
  CycleBranches(const std::function<ControlLoop(double)>& loop_at, const std::vector<double>& parameters);

  /// @param breaking  a symmetry breaking of a symmetric cycle that is a motion
  void add_from(const CycleEvent& breaking);

  std::vector<CycleBranch> found;

 private:
  [[nodiscard]] std::optional<ImpactCycle> born_at(double parameter, double omega) const;
  void follow(CycleBranch& branch, const ImpactCycle& first, double parameter);
  [[nodiscard]] std::optional<ImpactCycle> near(const ImpactCycle& cycle, double parameter) const;
  void look_between(CycleBranch& branch, const CycleBranch::Sample& a, const CycleBranch::Sample& b) const;

  const std::function<ControlLoop(double)>& loop_at_;
  std::vector<double> parameters_;  // rising
  double step_;                     // between them, the least
};

}  // namespace backlash::detail
