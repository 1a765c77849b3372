// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace backlash {

/// A contact with a stiffness and a damping that presses and does not pull (Kelvin-Voigt without tension): its force is
/// max(0, k d + c d') where bodies overlap by d > 0, and 0 elsewhere.
class CompliantContact {
 public:
  /// @param stiffness  k, N/m, > 0
  /// @param damping    c, N s/m, >= 0
  /// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
  CompliantContact(double stiffness, double damping);
  /// Of bodies whose reduced mass is m = M1 M2/(M1 + M2).
  /// @param frequency      wc = sqrt(k/m), rad/s, > 0
  /// @param damping_ratio  zeta = c/(2 sqrt(k m)), >= 0
  /// @throws std::invalid_argument  likewise; also where k or c leaves the range of numbers.
  static CompliantContact from_frequency(double frequency, double damping_ratio, double mass1, double mass2);

  [[nodiscard]] double stiffness() const noexcept { return stiffness_; }
  [[nodiscard]] double damping() const noexcept { return damping_; }

 private:
  double stiffness_, damping_;
};

/// What a contact does to two bodies that meet and on which nothing else acts.
struct FreeContact {
  double frequency;      // wc = sqrt(k/m), rad/s, m = M1 M2/(M1 + M2)
  double damping_ratio;  // zeta = c/(2 sqrt(k m))
  double restitution;    // speed after over speed before
  double duration;       // s, until the force is 0; the bodies overlap a little longer
};
/// @param mass1,mass2  kg, > 0
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed.
[[nodiscard]] FreeContact free_contact(const CompliantContact& contact, double mass1, double mass2);

/// Restitution of a contact with that damping ratio.  The force ends before the overlap, as the contact does not pull,
///   e = exp(-2 zeta acos(zeta)/sqrt(1 - zeta^2)), above 1 with acosh and sqrt(zeta^2 - 1): exp(-2) at 1, 1/(4 zeta^2)
/// far above.  (exp(-pi zeta/sqrt(1 - zeta^2)) is that of a contact that pulls.)
/// @param damping_ratio  >= 0
/// @throws std::invalid_argument  naming it.
[[nodiscard]] double restitution_of_damping_ratio(double damping_ratio);
/// Its inverse.
/// @param restitution  in (0, 1]; no damping makes contacts that lose all speed
/// @throws std::invalid_argument  naming it.
[[nodiscard]] double damping_ratio_of_restitution(double restitution);

}  // namespace backlash
