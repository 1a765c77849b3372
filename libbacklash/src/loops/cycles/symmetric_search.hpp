// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/loops/limit_cycles.hpp"
#include "loops/equations/gap_response.hpp"

namespace backlash::detail {

/// The symmetric cycles with two impacts per period of one loop: the equation of their frequencies, and what follows
/// from a root.
class SymmetricSearch {
 public:
  /// @throws std::invalid_argument  as symmetric_cycles().
  SymmetricSearch(const ControlLoop& loop, const LimitCycleOptions& options);

  /// All of them are roots of one sum of powers, so that none can be missing.
  [[nodiscard]] bool is_closed_form() const;
  /// No loss in the impacts and none to make up for.
  [[nodiscard]] bool any_frequency() const;
  [[nodiscard]] const FrequencyRange& range() const noexcept { return range_; }
  /// Rising.
  [[nodiscard]] std::vector<double> frequencies() const;
  /// 0 at the frequency of a cycle; its speed less that which the impacts ask for, over the latter.
  [[nodiscard]] double rate_defect(double omega) const;

  [[nodiscard]] SymmetricCycle cycle_at(double omega) const;
  /// Why there is no motion; empty where there is one.
  [[nodiscard]] std::string inadmissibility(double omega) const;

  /// Where bodies without a spring to ground drift under impulses that do not cancel, a cycle can become asymmetric by
  /// its instants alone.  It does where this changes its sign: the second derivative, half a period after an impact, of
  /// the answer to impulses of one sign, whose mean is left out.
  [[nodiscard]] double symmetry_defect(double omega) const;

 private:
  const ControlLoop* loop_;
  LimitCycleOptions options_;
  ImpulseAnswer response_;
  FrequencyRange range_;
  double exchange_;  // speed of the impacts over their impulse
};

}  // namespace backlash::detail
