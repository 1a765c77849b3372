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
    const double before = std::abs(displacement_.phase) + std::abs(displacement_.velocity);
    displacement_ = pushed(displacement_, motion, from, flight, to);
    const double size = std::abs(displacement_.phase) + std::abs(displacement_.velocity);
    if (!(size > 1e-60 && size < 1e60)) renormalise();
    return size / before;
  }
  [[nodiscard]] double log_growth() noexcept {
    renormalise();
    return log_growth_;
  }

 private:
  void renormalise() noexcept {
    const double size = std::abs(displacement_.phase) + std::abs(displacement_.velocity);
    // A disturbance lost at restitution 0, or grown without bound at a touch of speed 0, begins anew.
    if (!(size > 0) || !std::isfinite(size)) {
      displacement_ = {1, 1};
      return;
    }
    log_growth_ += std::log(size);
    displacement_.phase /= size;
    displacement_.velocity /= size;
  }

  Displacement displacement_{1, 1};
  double log_growth_ = 0;
};

}  // namespace backlash::detail
