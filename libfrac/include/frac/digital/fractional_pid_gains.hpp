// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace frac {

/// C(s) = kp + ki/s^lambda + kd s^mu.  Units follow the loop: with u = C e, kp is that of u/e, ki times s^-lambda, kd
/// times s^mu.  lambda = mu = 1 is the classical PID.
struct FractionalPidGains {
  double kp = 1;
  double ki = 0;
  double kd = 0;
  double lambda = 1;  // order of integration, within (0, 2)
  double mu = 1;      // order of differentiation, within (0, 2)
  bool operator==(const FractionalPidGains&) const = default;
};

}  // namespace frac
