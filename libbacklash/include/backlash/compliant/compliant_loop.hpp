// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant/compliant_history.hpp"
#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "backlash/loops/simulate_sampled_loop.hpp"

namespace backlash {

/// A ControlLoop around two bodies whose contact has a stiffness and a damping, with dry friction on each.
class CompliantLoop {
 public:
  /// @param controller  C, N per m of position
  /// @param measured    x1: the load; x2: the driven body
  /// @throws std::invalid_argument  as ControlLoop.
  CompliantLoop(CompliantBodies bodies, frac::FractionalTransferFunction controller, Output measured = Output::x1);

  [[nodiscard]] const CompliantBodies& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const frac::FractionalTransferFunction& controller() const noexcept { return hard_.controller(); }
  [[nodiscard]] Output measured() const noexcept { return hard_.measured(); }
  /// With the restitution of a free contact in place of stiffness and damping, and without dry friction.
  [[nodiscard]] const ControlLoop& hard() const noexcept { return hard_; }

 private:
  CompliantBodies bodies_;
  ControlLoop hard_;
};

struct CompliantLoopRow : CompliantRow {
  double force;  // N, of the controller on body 2
};

struct CompliantLoopHistory {
  std::vector<CompliantLoopRow> rows;  // time rising
  std::size_t contacts;                // that have begun
  LoopEnd end;                         // duration, most_impacts (contacts), most_flights or diverged
  double end_time;                     // s
  double realisation_error;            // as of LoopHistory
};

/// Motion of the loop from event to event: contacts begin and end, bodies stick and slide, the actuator reaches its
/// limit.  Flights are exact for whole powers of s and to the tolerance for fractional ones, and no event is missed.
/// @param options  most_impacts counts contacts; rows_at_impacts is for rows at events
/// @throws std::invalid_argument  whole_memory; a dead time; contacts more than 10^6 times as fast as the rigid loop at
/// its
///                                crossover, or with c/m above 10^9 times; else as simulate_loop() of a ControlLoop.
[[nodiscard]] CompliantLoopHistory simulate_loop(const CompliantLoop& loop, const LoopStart& start,
                                                 const SetPoint& set_point, const LoopSimulationOptions& options = {});

/// The same with the controller in a computer, as simulate_sampled_loop() of a ControlLoop, with a dead time of whole
/// samples and forces on both bodies: from event to event while the force is held.
/// @return a row per sample, with the force that is held from there on
/// @throws std::invalid_argument  as both, but of any bodies.
[[nodiscard]] CompliantLoopHistory simulate_sampled_loop(const CompliantLoop& loop, const SampledLoopOptions& options);

/// Where both bodies can rest under a constant set-point, stuck by dry friction: from the least to the largest measured
/// position, m.  Infinite where nothing brings it back, NaN where no rest exists.
struct RestRange {
  double from;
  double to;
};

/// Range of the equilibria without a limit of the force: those of body 1 have |contact force - K1 x1| <= Fc1 and those
/// of body 2 |C(0) (set_point - x) - contact force - K2 x2| <= Fc2, with K the stiffness of its receptance at rest.
/// With an integral in the controller there is rest at the set-point alone.  Whether a motion comes to rest there is
/// another question.
/// @param set_point  m, finite
[[nodiscard]] RestRange rest_range(const CompliantLoop& loop, double set_point);

}  // namespace backlash
