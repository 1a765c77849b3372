// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "backlash/compliant/compliant_loop.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"

namespace backlash {

/// What the describing function N(F, omega) of the bodies under a sine force says of a cycle: the solution of
/// 1 + C(j omega) N = 0 next to it.
struct CompliantPrediction {
  double omega;            // rad/s
  double force_amplitude;  // N, peak
  bool stable;             // by Loeb's criterion
};

/// A periodic motion of the loop in which bodies meet.  The mirror image of an asymmetric one is another, which is not
/// listed beside it.
struct CompliantCycle {
  double omega;         // rad/s
  bool symmetric;       // the second half of the period is the mirror image of the first
  int contacts;         // per period: times that bodies meet
  int sticks;           // per period: times that dry friction brings a body to rest
  double impact_speed;  // m/s, of the hardest meeting, which is at x2 - x1 = +clearance/2 and t = 0
  double impulse;       // N s, of that contact on body 1
  LoopStart start;      // as they meet
  /// Multipliers of the half period of a symmetric cycle, else of the period, without that of a shift in time.
  CycleStability stability;
  /// Largest distance from closure, over the sizes of the states.
  double error;
  std::vector<CycleHarmonic> harmonics;  // of orders 1, 2, 3, ...
  std::optional<CompliantPrediction> predicted;
};

/// What became of one start.
struct CompliantMotion {
  LoopStart start;
  LoopRegime regime;  // quiet: bodies meet no more
  std::optional<std::size_t>
      cycle;  // index in CompliantCycles::cycles; none too of a cycle outside the range asked for
};

struct CompliantCycles {
  std::vector<CompliantCycle> cycles;    // by rising omega
  std::vector<CompliantMotion> motions;  // one per start
  double realisation_error;              // of fractional powers, as of LoopHistory
};

struct CompliantCycleOptions {
  std::optional<FrequencyRange> range;  // of cycles that are listed; all are looked for
  int starts = 3;                       // 0 or more
  std::uint64_t seed = 1;
  std::size_t contacts = 600;  // followed from each start at most
  int harmonics = 5;           // listed of each cycle, 1 or more
  double tolerance = 1e-9;     // of fractional powers, as of LoopSimulationOptions
};

/// Cycles that motions from seeded starts settle on, and those that the symmetric cycles of the hard loop become,
/// stable or not, as its contacts soften and dry friction sets in: closed by Newton's method on the flow from one
/// meeting of the bodies to the next, its derivative being the product of the flights' and of the jumps at events.
/// Exact but for rounding for whole powers of s.  That no other cycle exists is not said; one in which bodies do not
/// meet, as where dry friction and an integral make a body creep within the clearance, is not looked for.
/// @throws std::invalid_argument  a range that is none; fewer than 0 starts, 0 contacts, fewer than one harmonic;
/// contacts as fast as
///                                simulate_loop() refuses.
[[nodiscard]] CompliantCycles compliant_cycles(const CompliantLoop& loop, const CompliantCycleOptions& options = {});

}  // namespace backlash
