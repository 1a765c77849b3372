// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/cascade_gains.hpp"

#include <cmath>

namespace frac {

FractionalPidGains pid_of(const CascadeGains& cascade) {
  const auto& [k1, k2, t] = cascade;
  return {.kp = k2 * (k1 + 1 / t), .ki = k1 * k2 / t, .kd = k2};
}

double setpoint_weight_of(const CascadeGains& cascade) {
  return 1 / (1 + 1 / (cascade.position_gain * cascade.integral_time));
}

std::optional<CascadeGains> cascade_of(const FractionalPidGains& gains) {
  const auto& [kp, ki, kd, lambda, mu] = gains;
  if (kd == 0 || mu != 1 || (ki != 0 && lambda != 1)) return std::nullopt;
  // z^2 - (kp/kd) z + ki/kd = 0 has the roots K1 and 1/T.
  const double half = kp / (2 * kd), product = ki / kd, square = half * half - product;
  if (!(half > 0) || !(product >= 0) || !(square >= 0)) return std::nullopt;
  const double faster = half + std::sqrt(square);
  return CascadeGains{faster, kd, faster / product};
}

}  // namespace frac
