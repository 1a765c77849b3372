// SPDX-License-Identifier: BSD-3-Clause
#include "forced_orbits.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "base/impact_law.hpp"
#include "gap_response.hpp"

namespace backlash::detail {

using Complex = std::complex<double>;

double ForcedOrbits::impulse_share(double omega) {
  return 2 * omega / std::numbers::pi;
}

ForcedOrbits::ForcedOrbits(const LinearBodies& bodies, double omega)
    : ForcedOrbits(bodies, gap_response(bodies), omega) {}

ForcedOrbits::ForcedOrbits(const LinearBodies& bodies, const ImpulseAnswer& response, double omega)
    : omega_(omega),
      half_clearance_(0.5 * bodies.system().clearance()),
      load_(bodies.load().response(omega)),
      drive_(bodies.drive().response(omega)) {
  const std::array<Complex, 3> train = ImpulseTrain(response, std::numbers::pi / omega).sums({0, omega});
  position_ = train[0].real();
  lag_ = -(speed_per_impulse(response.jump, bodies.system()) + train[1].real()) / omega;
  lowest_ = -half_clearance_ * position_ / (position_ * position_ + lag_ * lag_);
}

ForcedOrbits::Orbit ForcedOrbits::of_impulse(double impulse) const {
  const Complex force = Complex(half_clearance_ + impulse * position_, impulse * lag_) / drive_;
  const double kick = impulse_share(omega_) * impulse;
  return {impulse, force, load_ * kick, drive_ * (force - kick)};
}

double ForcedOrbits::least_force() const {
  return std::abs(of_impulse(lowest_).force);
}

ForcedOrbits::Orbit ForcedOrbits::at(double force, bool is_faster) const {
  // |F G2|^2 = least^2 + (position^2 + lag^2) (I - lowest)^2
  const double least = std::abs(drive_) * least_force();
  const double wanted = std::abs(drive_) * force;
  const double distance = std::sqrt(std::max(0.0, (wanted - least) * (wanted + least))) / std::hypot(position_, lag_);
  return of_impulse(lowest_ + (is_faster ? distance : -distance));
}

}  // namespace backlash::detail
