// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/simulate_loop.hpp"

namespace backlash {

/// An impact of a periodic motion.
struct CycleImpact {
  double time;     // s, from the first one of the period
  double impulse;  // N s, on mass 1: positive at x2 - x1 = +clearance/2
  double speed;    // m/s, of the masses towards each other
};

/// A part of a periodic motion over which the masses stay at a wall together.
struct CycleRest {
  double time;      // s, from the first impact of the period
  double duration;  // s
  double impulse;   // N s, of the wall on mass 1 meanwhile: positive at x2 - x1 = +clearance/2
};

/// A periodic motion of the loop with any number of impacts per period, symmetric or not, and rests in contact.  The
/// mirror image x -> -x of an asymmetric motion is another one, which is not listed beside it.
struct ImpactCycle {
  double period;                     // s
  std::vector<CycleImpact> impacts;  // of one period; the first is the hardest, at +clearance/2
  /// Of one period.  Impacts that follow each other without end before a rest are listed as far as they are faster than
  /// 1e-10 of the motion.
  std::vector<CycleRest> rests;
  double middle;       // m, mean of x2 - x1
  bool symmetric;      // the second half of the period is the mirror image of the first
  bool admissible;     // the motion exists: impacts push, and between them it stays off the walls
  std::string reason;  // one sentence where it is not admissible, else empty
  /// Multipliers per period.  With fractional powers those of modulus below 1 on the positive
  /// axis lie on a cut and are not seen.  Of a cycle with rests they are known to 1e-6.
  CycleStability stability;
  /// Largest relative change of instants and impulses in the last step of Newton's method.  Of a cycle with rests that
  /// of the state, or the relative error of fractional powers as sums of exponentials where that is larger.
  double error;
  std::vector<CycleHarmonic> harmonics;  // of orders 1, 2, 3, ..., the first impact at t = 0
};

/// A motion that nearly repeats: where Newton's method begins.
struct CycleGuess {
  double period;                     // s
  std::vector<CycleImpact> impacts;  // the first at time 0, times rising and below the period; speeds are not read
};

/// The cycle next to a guess, exact to rounding, with the whole memory of fractional orders: instants and impulses
/// solve
///   y(t_a) = +-clearance/2,   y'(t_a) = h1 I_a/(1 + restitution),   h1 = 1/M1 + 1/M2,
///   y(t) = middle - sum_b I_b sum_l g(t - t_b + l period),
/// g what an impulse makes of the gap; its sums over all earlier periods are those of symmetric cycles.
/// @param harmonics  listed
/// @return empty where Newton's method finds none
/// @throws std::invalid_argument  a guess without impacts or with times that are not rising within a period; as
///                                symmetric_cycles().
[[nodiscard]] std::optional<ImpactCycle> close_cycle(const ControlLoop& loop, const CycleGuess& guess,
                                                     int harmonics = 5);

/// The shortest pattern of at most `most` impacts that the last impacts of a motion repeat to within `tolerance` of its
/// period and of its fastest impact; empty where they repeat none.
[[nodiscard]] std::optional<CycleGuess> repeated_pattern(const ControlLoop& loop,
                                                         const std::vector<LoopImpact>& impacts, std::size_t most = 12,
                                                         double tolerance = 0.02);

/// What a motion of a loop comes to.
enum class LoopRegime {
  cycle,      // a stable cycle
  quiet,      // impacts cease: it rests in contact or moves within the clearance
  irregular,  // it repeats no pattern of up to twelve impacts or rests, or too slowly to tell
  diverged,   // it grows without bound
};
/// "cycle", "quiet", ...
[[nodiscard]] std::string_view to_string(LoopRegime regime);

struct LoopMotion {
  LoopStart start;
  LoopRegime regime;
  std::optional<std::size_t> cycle;  // index in ImpactCycles::cycles
  /// 1/s, mean rate at which neighbouring motions part: see `chaotic`.  Of irregular motions of
  /// loops without dead time that do not rest in contact; else NaN.
  double lyapunov_exponent;
  /// The exponent is larger than that of neighbours that part in proportion to time, as those of a regular motion may.
  bool chaotic = false;
};

struct ImpactCycles {
  /// Stable, by rising frequency; symmetric ones of two impacts too, and without dead time those that rest in contact.
  std::vector<ImpactCycle> cycles;
  std::vector<LoopMotion> motions;  // one per start
};

struct ImpactCycleOptions {
  int starts = 3;  // 0 or more
  std::uint64_t seed = 1;
  std::size_t impacts = 600;  // followed from each start at most
  int harmonics = 5;          // listed of each cycle, 1 or more
};

/// Cycles that motions from seeded starts settle on, and what becomes of the others.  Speeds at the start are 0.2 to 5
/// times the clearance times the crossover frequency of the rigid loop.  That no other stable cycle exists is not said.
/// @throws std::invalid_argument  fewer than 0 starts, 0 impacts; as close_cycle().
[[nodiscard]] ImpactCycles impact_cycles(const ControlLoop& loop, const ImpactCycleOptions& options = {});

/// Those of the cycles found that are not among the symmetric ones of two impacts.
[[nodiscard]] std::vector<const ImpactCycle*> further_cycles(const std::vector<ImpactCycle>& found,
                                                             const std::vector<SymmetricCycle>& listed);

}  // namespace backlash
