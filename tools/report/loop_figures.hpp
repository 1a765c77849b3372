// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/compliant/compliant_cycles.hpp"
#include "backlash/loops/cycle_continuation.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "report/figure.hpp"

namespace report {

/// What is known of a loop.
struct LoopPicture {
  backlash::ControlLoop loop;
  backlash::LimitCycles exact;  // with some hundred harmonics for cycle_figure()
  std::vector<backlash::PredictedCycle> predicted;
};

/// The rigid loop C(jw)/((M1 + M2) w^2) against the lines -1/nu of the symmetric orbits, one per restitution: the
/// describing function predicts a cycle where it meets the line of its own restitution.  Exact cycles are marked on it.
/// Such lines exist for free masses with the load measured only.
[[nodiscard]] Figure nyquist_figure(const LoopPicture& picture, std::string name, std::string caption);

/// Positions and force over a period of the first cycle that is a motion, and the phase portrait of the gap.
/// @param cycle  with the harmonics to draw
[[nodiscard]] Figure cycle_figure(const backlash::ControlLoop& loop, const backlash::SymmetricCycle& cycle,
                                  std::string name, std::string caption);
/// The same of contacts that take time.
[[nodiscard]] Figure cycle_figure(const backlash::CompliantLoop& loop, const backlash::CompliantCycle& cycle,
                                  std::string name, std::string caption);

/// The gap over the first periods from rest, the driven body pushed at the speed of impact of the cycle: of the
/// continuous loop, and of its controller in a computer with 50 samples per period.
/// @param loop  of free masses and a controller kp + kd s^mu
[[nodiscard]] Figure start_figure(const backlash::ControlLoop& loop, const backlash::SymmetricCycle& cycle,
                                  std::string name, std::string caption);

/// The loops over one quantity.
struct LoopFamilyPicture {
  std::string quantity;  // enhanced text
  std::vector<double> values;
  std::vector<LoopPicture> loops;
  std::vector<backlash::CycleEvent> events;
};

/// Frequencies of the exact cycles, stable ones apart from others, beside the predicted ones.
[[nodiscard]] Figure frequencies_figure(const LoopFamilyPicture& family, std::string name, std::string caption);

}  // namespace report
