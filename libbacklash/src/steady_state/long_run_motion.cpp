// SPDX-License-Identifier: BSD-3-Clause
#include "long_run_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace backlash::detail {

double tail_limit(const GapMotion& motion, double tolerance) {
  return 1e-3 * tolerance * std::min(1.0, std::cbrt(1 / motion.gamma()));
}

double energy_defect(const GapMotion& motion, const Harmonics& harmonics, double half_periods, double squared_speeds,
                     double tail_loss) {
  const double work = -0.5 * std::numbers::pi * half_periods * motion.gamma() * harmonics.u[0].imag();
  const double kept = motion.restitution() * motion.restitution();
  const double loss = 0.5 * (1 - kept) * squared_speeds + tail_loss;
  return squared_speeds > 0 ? std::abs(work - loss) / (0.5 * squared_speeds) : 0;
}

}  // namespace backlash::detail
