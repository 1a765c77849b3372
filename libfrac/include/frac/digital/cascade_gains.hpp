// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "frac/digital/fractional_pid_gains.hpp"

namespace frac {

/// A position controller around a speed controller, both of one encoder: u = K2 (1 + 1/(T s)) (K1 (r - y) - s y).
/// That is a PID with the proportional part on a share of the set-point and the derivative on the measurement:
///   kp = K2 (K1 + 1/T), ki = K1 K2/T, kd = K2, setpoint_weight = K1 T/(1 + K1 T), derivative_setpoint_weight = 0.
struct CascadeGains {
  double position_gain;                                            // K1, 1/s, > 0
  double speed_gain;                                               // K2, of u over the rate of y
  double integral_time = std::numeric_limits<double>::infinity();  // T, s, > 0; infinite: no integral
};

[[nodiscard]] FractionalPidGains pid_of(const CascadeGains& cascade);
/// In (0, 1].
[[nodiscard]] double setpoint_weight_of(const CascadeGains& cascade);
/// The cascade with these gains: of the two zeros of C = kd (s + K1) (s + 1/T)/s the faster is K1.  Empty where it has
/// none: orders other than 1, no derivative, or kp^2 < 4 ki kd, whose zeros are complex; and where K1 or T is negative.
[[nodiscard]] std::optional<CascadeGains> cascade_of(const FractionalPidGains& gains);

}  // namespace frac
