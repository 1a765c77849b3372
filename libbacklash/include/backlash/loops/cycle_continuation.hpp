// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"

namespace backlash {

/// What happens to a symmetric cycle at one value of a parameter.
enum class CycleEventKind {
  fold,               // two cycles meet and vanish
  symmetry_breaking,  // stability is lost to cycles with halves of unequal length
  torus,              // stability is lost to a second frequency
  admissibility,      // beyond it the equations have the root but there is no such motion
  period_doubling,    // of a cycle that is not symmetric: stability is lost to cycles of twice its period
  range_end,          // its frequency leaves the range that is searched, or goes to 0 or infinity
};
/// "fold", "symmetry-breaking", ...
[[nodiscard]] std::string_view to_string(CycleEventKind kind);

struct CycleEvent {
  CycleEventKind kind;
  double parameter;
  double omega;        // rad/s, of the cycle there
  bool is_admissible;  // the cycle is a motion there, or on one side of it
  std::string reason;  // of an admissibility limit: why there is no motion beyond, else empty
};

struct ParameterInterval {
  double from;
  double to;
};

/// Asymmetric cycles of two impacts that begin where a symmetric one breaks its symmetry, over the values on their side
/// of that.  The mirror image of each is another one and not listed beside it.
struct CycleBranch {
  double born_at;
  struct Sample {
    double parameter;
    ImpactCycle cycle;
  };
  /// Right after it begins and at the values asked for, as far as it is a motion.
  std::vector<Sample> samples;
  std::vector<CycleEvent> events;  // in the order in which it meets them, refined as those of symmetric cycles
};

/// The symmetric cycles of a loop over a parameter.
struct CycleContinuation {
  struct Sample {
    double parameter;
    LimitCycles found;
  };
  std::vector<Sample> samples;     // at the values asked for
  std::vector<CycleEvent> events;  // in their order, each parameter to 1e-10 of its size or of the step
  /// Where no symmetric cycle with two impacts per period is a motion; the ends are events or those of the values.
  std::vector<ParameterInterval> without_cycles;
  /// Newton's method goes from value to value: a branch that turns back in the parameter ends there.
  std::vector<CycleBranch> branches;
  /// Where no symmetric cycle is stable; holds those above.
  std::vector<ParameterInterval> without_stable_cycles;
};

/// Follows all symmetric cycles from value to value and refines what happens between.  Two events of one cycle that
/// undo each other between neighbouring values are not seen.
/// @param loop_at     the loop at a value of the parameter
/// @param parameters  two or more, strictly rising or strictly falling
/// @throws std::invalid_argument  values that are not; as symmetric_cycles() and `loop_at`.
[[nodiscard]] CycleContinuation continue_cycles(const std::function<ControlLoop(double)>& loop_at,
                                                const std::vector<double>& parameters,
                                                const LimitCycleOptions& options = {});

}  // namespace backlash
