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
  /// A step and a ramp; its lag only where the controller is 0 at s = -1/lag: that of a cascade.  The PID then has the
  /// set-point weights kd/(lag kp) and 0, which is the same but for the integral of the speed, half a sample apart.
  SetPoint set_point;
  Disturbance disturbance;  // of body 2 alone where contacts take no time
  double encoder_step = 0;  // m, >= 0: the controller reads the nearest multiple; 0: the position itself
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
