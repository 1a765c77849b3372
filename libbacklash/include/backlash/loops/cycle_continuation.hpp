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

/// A cycle that is not a symmetric one of two impacts, over the values: one that begins where a symmetric cycle breaks
/// its symmetry, on its side of that, or one that a simulated motion came to, to both sides.  The mirror image of an
/// asymmetric one is another one and not listed beside it.  One that rests in contact is known at the values asked for
/// alone, and taken to be there between two neighbours that both have one of the same pattern.
struct CycleBranch {
  double born_at;  // NaN of one that was found by simulation
  struct Sample {
    double parameter;
    ImpactCycle cycle;
  };
  /// Right after it begins, or where it was found, and at the values asked for, as far as it is a motion; of one that
  /// rests in contact in the order of these.
  std::vector<Sample> samples;
  std::vector<CycleEvent> events;  // in the order in which it meets them, refined as those of symmetric cycles
  std::vector<ParameterInterval> admissible;  // where it is a motion, as far as it was followed; rising
  std::vector<ParameterInterval> stable;      // where it is a stable one
};

/// The symmetric cycles of a loop over a parameter.
struct CycleContinuation {
  struct Sample {
    double parameter;
    LimitCycles found;
  };
  std::vector<Sample> samples;     // at the values asked for
  std::vector<CycleEvent> events;  // in their order, each parameter to 1e-10 of its size or of the step
  /// Newton's method goes from value to value: a branch that turns back in the parameter ends there.
  std::vector<CycleBranch> branches;
  /// Where no symmetric cycle with two impacts per period is a motion and none of `branches`; the ends are events or
  /// those of the values.
  std::vector<ParameterInterval> without_cycles;
  /// Where none of them is stable; holds those above.
  std::vector<ParameterInterval> without_stable_cycles;
  /// Of the values asked for: where motions were simulated to look for stable cycles of any number of impacts.
  std::vector<double> simulated;
};

/// Follows all symmetric cycles from value to value and refines what happens between.  Two events of one cycle that
/// undo each other between neighbouring values are not seen.
/// @param loop_at     the loop at a value of the parameter
/// @param parameters  two or more, strictly rising or strictly falling
/// @param starts      motions that impact_cycles() simulates at each value at which no stable cycle is known otherwise;
///                    stable cycles that they come to are followed to both sides
/// @throws std::invalid_argument  values that are not; as symmetric_cycles() and `loop_at`.
[[nodiscard]] CycleContinuation continue_cycles(const std::function<ControlLoop(double)>& loop_at,
                                                const std::vector<double>& parameters,
                                                const LimitCycleOptions& options = {}, int starts = 0);

}  // namespace backlash
