// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/loops/control_loop.hpp"

namespace backlash {

/// How a cycle is left when it is not stable.
enum class StabilityLoss {
  none,
  /// The multiplier of the half period of largest modulus is real and below -1: the halves become unequal.
  symmetry_breaking,
  saddle_node,      // it is real and above 1
  torus,            // it is one of a complex pair: a second frequency appears
  period_doubling,  // of an ImpactCycle: the multiplier of its period is real and below -1
};
/// "none", "symmetry-breaking", ...
[[nodiscard]] std::string_view to_string(StabilityLoss loss);

/// Growth of small disturbances from one impact to the next, the whole memory of the controller included.
struct CycleStability {
  bool stable;
  /// Multipliers of modulus above 1 per half period, the one of a shift in time left out; -1 where one is so near the
  /// unit circle that it cannot be told.
  int unstable_multipliers;
  /// The multiplier of largest modulus, none larger by a count; 0 where none is larger than 0.05 in modulus, NaN where
  /// it was not found.  A fractional controller remembers by powers of time besides, so that disturbances of a stable
  /// cycle vanish no faster than those.
  std::complex<double> dominant;
  StabilityLoss loss;
};

/// Phasors of one harmonic as peak values: the motion is Re sum phasor e^{j order omega t}, the impact at
/// x2 - x1 = +clearance/2 at t = 0.
struct CycleHarmonic {
  int order;                   // 1, 3, 5, ...
  std::complex<double> x1;     // m
  std::complex<double> x2;     // m
  std::complex<double> force;  // N
};

/// A symmetric motion of the loop with two impacts per period, at opposite walls.
struct SymmetricCycle {
  double omega;         // rad/s
  double impulse;       // N s, on mass 1 at x2 - x1 = +clearance/2; negative where no motion exists
  double impact_speed;  // m/s, of the masses towards each other
  bool admissible;      // the motion exists: it stays off the walls between its impacts
  std::string reason;   // one sentence where it is not admissible, else empty
  CycleStability stability;
  std::vector<CycleHarmonic> harmonics;
};

struct FrequencyRange {
  double from;  // rad/s, > 0
  double to;    // rad/s, > from
};

struct LimitCycleOptions {
  /// Where cycles are looked for; by default wherever they can be, for a ratio of sums of powers from 1e-4 to 1e4
  /// rad/s.
  std::optional<FrequencyRange> range;
  int harmonics = 5;  // odd harmonics listed, 1 or more
};

struct LimitCycles {
  std::vector<SymmetricCycle> cycles;  // by rising omega, inadmissible ones too
  /// Where it was looked; 0 to infinity, or 1e-60 to 1e60 rad/s, where the count of all roots is certain.
  FrequencyRange searched;
  /// No root in `searched` can be missing.  Else its grid of at least 200 points per decade and per turn of the dead
  /// time decides.
  bool certain;
  /// Every frequency is one of a cycle: no loss in the impacts and none to make up for (restitution 1, a controller
  /// that neither brakes nor drives).
  bool any_frequency;
};

/// All symmetric cycles with two impacts per period, exact to rounding, with the whole memory of fractional orders.
/// Of free masses with the load measured and a controller that is a sum of powers of s, the sums over all earlier
/// impacts are closed forms, with dead time too; other bodies, a ratio of sums of powers, or the driven body measured,
/// cost an inverse Laplace transform.
/// @throws std::invalid_argument  dead time with the driven body measured; a range that is none; fewer than one
///                                harmonic.
[[nodiscard]] LimitCycles symmetric_cycles(const ControlLoop& loop, const LimitCycleOptions& options = {});

}  // namespace backlash
