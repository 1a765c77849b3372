// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace backlash {

/// Two free masses on a line; mass 2 sits inside a clearance of mass 1 and carries the force F cos(omega t).  Impacts
/// at x1 = x2 and x2 = x1 + clearance obey Newton's restitution and keep momentum (Duarte, Tenreiro Machado 2009, eqs.
/// 2-4).
class TwoMassSystem {
 public:
  /// @param mass1,mass2   kg, > 0
  /// @param clearance     m, >= 0; 0 joins the masses rigidly
  /// @param restitution   in [0, 1]
  /// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
  TwoMassSystem(double mass1, double mass2, double clearance, double restitution);

  [[nodiscard]] double mass1() const noexcept { return mass1_; }
  [[nodiscard]] double mass2() const noexcept { return mass2_; }
  [[nodiscard]] double clearance() const noexcept { return clearance_; }
  [[nodiscard]] double restitution() const noexcept { return restitution_; }

 private:
  double mass1_, mass2_, clearance_, restitution_;
};

/// gamma = F/(M2 clearance omega^2), the only group besides restitution the motion depends on.  Infinite at clearance
/// 0.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, > 0
/// @throws std::invalid_argument  force_amplitude or omega not positive and finite.
[[nodiscard]] double dimensionless_force(const TwoMassSystem& system, double force_amplitude, double omega);

/// w_L = sqrt(2F/(clearance M2)) in rad/s (eq. 6): above it masses that start in contact at rest, the force at its
/// peak, meet no second wall.  Infinite at clearance 0.
/// @throws std::invalid_argument  force_amplitude not positive and finite.
[[nodiscard]] double limit_frequency(const TwoMassSystem& system, double force_amplitude);

struct ImpactVelocities {
  double mass1;  // m/s
  double mass2;  // m/s
};
/// Velocities after an impact from those before it (eq. 4).
[[nodiscard]] ImpactVelocities post_impact_velocities(const TwoMassSystem& system, ImpactVelocities before) noexcept;

/// Energy lost in one impact at that relative velocity (m/s), in J (eq. 5).
[[nodiscard]] double impact_energy_loss(const TwoMassSystem& system, double relative_velocity) noexcept;

}  // namespace backlash
