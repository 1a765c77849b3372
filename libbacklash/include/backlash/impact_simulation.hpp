// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "backlash/two_mass_system.hpp"

namespace backlash {

/// Relative motion y = x2 - x1 where the force F cos(omega t) is at its peak.
struct RelativeState {
  double position = 0;  // m, in [0, clearance]
  double velocity = 0;  // m/s; at a wall not into it
};

/// Contact of the masses.
enum class Wall {
  near,  // x1 = x2
  far,   // x2 = x1 + clearance
};

struct Impact {
  double time;  // s since the start
  Wall wall;
  ImpactVelocities before;  // in the frame in which the centre of mass has no mean velocity
  ImpactVelocities after;
  double energy_loss;  // J
};

/// Time spent in contact, pressed together by the force.
struct Rest {
  double from;  // s
  double to;    // s
  Wall wall;
  double chatter_energy_loss;  // J lost in the last impacts before it, which are not listed
};

struct ImpactHistory {
  std::vector<Impact> impacts;
  std::vector<Rest> rests;
  double duration;    // s followed: that asked for, or the time of the last impact allowed
  bool complete;      // false where max_impacts ended it early
  RelativeState end;  // at `duration`
};

/// Follows the two masses impact by impact, without time steps: each flight and each time of impact is exact but for
/// rounding. Infinitely many impacts in finite time (chatter) are listed until their remaining effect on the mean of y
/// is below 1e-13 of the clearance; the masses then rest in contact.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, > 0; F/(M2 clearance omega^2) in (0, 1e30)
/// @param start            at t = 0
/// @param periods          of the force to follow, > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; clearance 0 has no impacts.
[[nodiscard]] ImpactHistory simulate_impacts(const TwoMassSystem& system, double force_amplitude, double omega,
                                             const RelativeState& start, int periods,
                                             std::size_t max_impacts = 1'000'000);

}  // namespace backlash
