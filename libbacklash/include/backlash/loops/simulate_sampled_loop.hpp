// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "frac/digital/fractional_pid.hpp"

namespace backlash {

struct SampledLoopOptions {
  double sample_time = 0;                                        // s, > 0: between samples of the controller
  double duration = 100;                                         // s, > 0
  double force_limit = std::numeric_limits<double>::infinity();  // N, > 0: of the actuator; the integral is held there
  double velocity1 = 0;                                          // m/s, at the start; both bodies begin at 0
  double velocity2 = 0;
  SetPoint set_point;
};

struct SampledLoopHistory {
  std::vector<LoopRow> rows;  // one per sample, with the force that is held from there on
  std::uint64_t impacts;      // a completed chatter counts as one
};

/// The controller of a loop of free masses as it runs in a computer: a FractionalPid with samples of the measured body
/// and a force that is held between them, which lets impacts, chatter and rests in contact be exact.  A dead time is
/// rounded to whole samples.
/// @throws std::invalid_argument  bodies that are no free masses; a controller that is not kp + ki/s^lambda + kd s^mu
///                                with orders below 2; a number that is none of the above; more than 10^7 samples.
[[nodiscard]] SampledLoopHistory simulate_sampled_loop(const ControlLoop& loop, const SampledLoopOptions& options);

/// The controller that it runs: fractional powers hold on the five decades up to a tenth of the Nyquist frequency.
/// @throws std::invalid_argument  as above.
[[nodiscard]] frac::FractionalPidConfig sampled_controller(const ControlLoop& loop, const SampledLoopOptions& options);

}  // namespace backlash
