// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/two_mass_system.hpp"
#include "frac/model/fractional_transfer_function.hpp"

namespace backlash {

/// Two bodies with clearance, each with a receptance of its own: displacement per force in m/N, such as
/// 1/(M s^2 + b s + k), 1/(M s^2 + c s^0.5) or 1/(M s^2) of a free mass.  Impacts exchange momentum between the masses
/// M = lim 1/(s^2 G), s -> infinity, as those of TwoMassSystem do.
class LinearBodies {
 public:
  /// Free masses.
  LinearBodies(const TwoMassSystem& system);
  /// @param load         receptance of body 1
  /// @param drive        receptance of body 2, on which the force acts
  /// @param clearance    m, > 0
  /// @param restitution  in [0, 1]
  /// @throws std::invalid_argument  a receptance with dead time, or one that does not fall as 1/(M s^2) at high
  ///                                frequency, M > 0: its velocity would not jump at an impact, or jump without end.
  LinearBodies(frac::FractionalTransferFunction load, frac::FractionalTransferFunction drive, double clearance,
               double restitution);

  /// Clearance, restitution, and the masses that impacts meet.
  [[nodiscard]] const TwoMassSystem& system() const noexcept { return system_; }
  [[nodiscard]] const frac::FractionalTransferFunction& load() const noexcept { return load_; }
  [[nodiscard]] const frac::FractionalTransferFunction& drive() const noexcept { return drive_; }
  [[nodiscard]] bool has_free_load() const noexcept { return has_free_load_; }
  /// Both are free masses.
  [[nodiscard]] bool are_free() const noexcept { return has_free_load_ && has_free_drive_; }

 private:
  TwoMassSystem system_;
  frac::FractionalTransferFunction load_;
  frac::FractionalTransferFunction drive_;
  bool has_free_load_;
  bool has_free_drive_;
};

/// Receptance of both bodies where the clearance is closed: 1/G = 1/G1 + 1/G2.
[[nodiscard]] frac::FractionalTransferFunction rigid_receptance(const LinearBodies& bodies);

/// 1/(mass s^2).
/// @param mass  kg, > 0
[[nodiscard]] frac::FractionalTransferFunction free_mass(double mass);

}  // namespace backlash
