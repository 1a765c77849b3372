// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/two_mass_system.hpp"

#include <cmath>

#include "check.hpp"

namespace backlash {

TwoMassSystem::TwoMassSystem(double mass1, double mass2, double clearance, double restitution)
    : mass1_(mass1), mass2_(mass2), clearance_(clearance + 0.0), restitution_(restitution) {
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  detail::require_not_negative("clearance", "m", clearance);
  detail::require_restitution(restitution);
}

double dimensionless_force(const TwoMassSystem& system, double force_amplitude, double omega) {
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_positive("omega", "rad/s", omega);
  return force_amplitude / system.mass2() / system.clearance() / omega / omega;
}

double limit_frequency(const TwoMassSystem& system, double force_amplitude) {
  detail::require_positive("force_amplitude", "N", force_amplitude);
  return std::sqrt(2 * force_amplitude / system.clearance() / system.mass2());
}

ImpactVelocities post_impact_velocities(const TwoMassSystem& system, ImpactVelocities before) noexcept {
  // Each mass keeps its velocity but for its share of the change (1 + e) of the relative velocity.
  const double total = system.mass1() + system.mass2();
  const double change = (1 + system.restitution()) * (before.mass1 - before.mass2);
  return {before.mass1 - system.mass2() / total * change, before.mass2 + system.mass1() / total * change};
}

double impact_energy_loss(const TwoMassSystem& system, double relative_velocity) noexcept {
  const double e = system.restitution();
  const double reduced_mass = system.mass1() / (system.mass1() + system.mass2()) * system.mass2();
  return (1 - e) * (1 + e) * reduced_mass / 2 * relative_velocity * relative_velocity;
}

}  // namespace backlash
