// SPDX-License-Identifier: BSD-3-Clause
#include "symmetric_orbits.hpp"

#include <cmath>
#include <numbers>

#include "closed_orbit.hpp"
#include "two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

SymmetricOrbits::SymmetricOrbits(double restitution)
    : restitution_(restitution),
      family_(restitution),
      first_(family_.saddle_node()),
      last_(symmetry_loss(restitution).gamma) {}

SteadyState SymmetricOrbits::at(double gamma) const noexcept {
  const double kept = 1 + restitution_;
  const double lost = 1 - restitution_;
  const SymmetricImpact impact = family_.at(gamma);
  const double speed = impact.speed;
  const double met = speed * speed;
  const double inverse_met = 1 / met;
  const double s1 = impact.sin_phase;
  const double c1 = impact.cos_phase;
  const double c2 = c1 * c1 - s1 * s1;
  const double s2 = 2 * s1 * c1;
  const double c3 = c1 * c2 - s1 * s2;
  const double s3 = s1 * c2 + c1 * s2;
  const double jump = -2 / pi * kept * speed;
  SteadyState steady;
  steady.regime = Regime::symmetric;
  steady.period = 1;
  steady.impacts_per_period = 2;
  steady.harmonics.u1_plus_gamma = {jump * c1, -jump * s1};
  steady.harmonics.u = {steady.harmonics.u1_plus_gamma - gamma,
                        std::complex<double>(jump / 9 * c3, -jump / 9 * s3),
                        std::complex<double>(jump / 25 * (c3 * c2 - s3 * s2), -jump / 25 * (s3 * c2 + c3 * s2)),
                        {}};
  steady.uncertainty = impact.uncertainty;
  const double half_trace = 2 * restitution_ + kept * pi * gamma * c1 * speed * inverse_met;
  const double half_radius = spectral_radius(half_trace, restitution_ * restitution_);
  steady.spectral_radius = half_radius * half_radius;
  steady.lyapunov = 2 * std::log(half_radius);
  // Work of the force per period and losses of both impacts, over the energy they meet, v^2.
  const double work = -pi * gamma * steady.harmonics.u[0].imag();
  steady.energy_defect = std::abs(work - lost * kept * met) * inverse_met;
  return steady;
}

GapState SymmetricOrbits::end_state(double gamma) const {
  const GapMotion motion(gamma, restitution_);
  return state_at_next_peak(motion, symmetric_two_impact_orbit(gamma, restitution_).value().start, 0);
}

}  // namespace backlash::detail
