// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_cycles.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "frac/identification/tune.hpp"

namespace backlash {

/// What the force of a controller moves, and the body that the controller gets.
struct BacklashPlant {
  LinearBodies bodies;
  Output measured = Output::x1;
  /// Where the contact has a stiffness and a damping, or bodies have dry friction; `bodies` is then its hard().
  std::optional<CompliantBodies> compliant = {};
};

/// A line of the answer: what was asked for or may not be passed, and whether it holds the answer where it is.
struct TuningConstraint {
  std::string name;  // e.g. "phase margin, deg", "mu at its upper end", "no limit cycle"
  double asked;
  double reached;
  bool active;
};

/// How a simulated motion ends that begins with the bodies at rest at 0 but for the speed of the driven one.
struct SimulatedMotion {
  double speed;   // m/s, at the start
  double swing;   // m, half of what the measured body goes from peak to peak in the last quarter; infinite: runs away
  double before;  // m, the same in the quarter before
  bool dies_out;  // it falls, and below a hundredth of the clearance
};

/// The motions of a loop that persist.
struct PersistentMotion {
  std::vector<SymmetricCycle> cycles;  // of two impacts, as far as they are motions, by rising omega
  FrequencyRange searched;             // where these were looked for
  bool certain;                        // see LimitCycles
  /// Stable cycles of any other kind that motions of impact_cycles() come to, those that rest in contact too.
  std::vector<ImpactCycle> further;
  /// In place of both where contacts take time: those of compliant_cycles(), which are never certain to be all; none
  /// with fractional powers, where simulations alone tell what persists.
  std::vector<CompliantCycle> compliant;
  /// Half of what the measured body goes from peak to peak, m: of the largest stable cycle, or as simulated where a
  /// simulation shows a larger motion that is none of the cycles and does not fall to one.  0 where nothing persists.
  double swing;
  double omega;  // rad/s, of the cycle that swing is of; NaN where it is of none
  std::vector<SimulatedMotion> simulations;
  /// One of the simulations comes to the largest stable cycle, to the 8 % that their steps may cost; or there is none,
  /// and swing is what they show.
  bool verified;
};

struct BacklashTuning {
  /// The demands are kept; persistent.swing tells whether a motion is left.
  [[nodiscard]] bool usable() const noexcept { return linear.usable(); }
  /// Controller, what became of the demands, and the motion that is left.
  [[nodiscard]] std::string summary() const;

  frac::TuningResult linear;  // controller, and what it makes of the bodies without clearance
  PersistentMotion persistent;
  frac::TuningResult regardless;  // as if there were no clearance, and
  PersistentMotion of_regardless;
  std::vector<TuningConstraint> constraints;
  std::string message;  // one sentence or two
};

/// Gains and orders that keep the demands on the loop without clearance, and with which no motion persists, or the
/// smallest one.  Where the controller of frac::tune() itself leaves none it is the answer; else frac::tune() searches
/// anew, for the least criterion where no motion is left and for the smallest swing where one is.  Exact cycles are
/// taken where they are stable; controllers with none are simulated, because motions of other kinds may persist (with
/// more impacts in a period, or contact).
/// Free masses under a controller without filter whose load is measured are searched by exact cycles, others by
/// simulations: in steps where the receptances are 1/(M s^2 + sum of c s^a), from impact to impact where they are not,
/// and from event to event where contacts take time: by simulate_loop() of a CompliantLoop.
/// Controllers are left out with which the loop falls more slowly than s^-0.5 at high frequency, or whose cycles are
/// faster than ten crossovers and than those of the controller of frac::tune(): no model holds there.
/// @throws std::invalid_argument  as frac::tune(), ControlLoop and symmetric_cycles(); no crossover; options with an
///                                objective.
[[nodiscard]] BacklashTuning tune_with_backlash(const BacklashPlant& plant,
                                                const frac::LoopSpecification& specification,
                                                const frac::TuningOptions& options = {});

}  // namespace backlash
