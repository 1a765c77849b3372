// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac {

/// Orders of integration and differentiation that a controller may have.  An order this far from 0 or 2 turns the phase
/// by 0.09 degrees from that of a gain or a double integrator, which no device shows, and equations for the gains lose
/// as many digits as it has zeros.
inline constexpr double least_controller_order = 1e-3, largest_controller_order = 2 - least_controller_order;

/// C(s) = kp + ki/s^lambda + kd s^mu.  Units follow the loop: with u = C e, kp is that of u/e, ki times s^-lambda, kd
/// times s^mu.  lambda = mu = 1 is the classical PID.
struct FractionalPidGains {
  double kp = 1;
  double ki = 0;
  double kd = 0;
  double lambda = 1;  // order of integration, 0.001 to 1.999
  double mu = 1;      // order of differentiation, 0.001 to 1.999
  bool operator==(const FractionalPidGains&) const = default;
};

}  // namespace frac
