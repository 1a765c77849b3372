// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "closed_orbit.hpp"
#include "motion/gap_motion.hpp"

namespace backlash::detail {

/// Growth of a small disturbance of a motion, followed from impact to impact.
class Disturbance {
 public:
  /// Returns the growth over this flight and impact.
  double advance(const GapMotion& motion, const GapState& from, const Flight& flight, const GapState& to) noexcept {
    const double before = std::abs(phase_) + std::abs(velocity_);
    const Jacobian step = chain({}, motion, from, flight, to);
    const double phase = step.phase_phase * phase_ + step.phase_velocity * velocity_;
    velocity_ = step.velocity_phase * phase_ + step.velocity_velocity * velocity_;
    phase_ = phase;
    const double size = std::abs(phase_) + std::abs(velocity_);
    if (!(size > 1e-60 && size < 1e60)) renormalise();
    return size / before;
  }
  [[nodiscard]] double log_growth() noexcept {
    renormalise();
    return log_growth_;
  }

 private:
  void renormalise() noexcept {
    const double size = std::abs(phase_) + std::abs(velocity_);
    // A disturbance lost at restitution 0, or grown without bound at a touch of speed 0, begins anew.
    if (!(size > 0) || !std::isfinite(size)) {
      phase_ = velocity_ = 1;
      return;
    }
    log_growth_ += std::log(size);
    phase_ /= size;
    velocity_ /= size;
  }

  double phase_ = 1;
  double velocity_ = 1;
  double log_growth_ = 0;
};

}  // namespace backlash::detail
