// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>

#include "compliant/compliant_orbit.hpp"
#include "compliant/symmetric_compliant_orbit.hpp"
#include "scene_response.hpp"

namespace backlash::detail {

/// h of the harmonics 1, 3 and 5 of one motion; empty beyond those that are asked for.
using MotionHarmonics = std::array<std::optional<std::complex<double>>, 3>;
constexpr std::size_t harmonic_place(int harmonic) {
  return static_cast<std::size_t>(harmonic / 2);
}

/// The motions of one force and frequency that were found last, from which Newton's method finds those of a scene
/// nearby.
struct FoundMotions {
  std::optional<SymmetricCompliantOrbit> symmetric;
  std::optional<CompliantOrbit> followed;
  int failures = 0;  // of following the motion from its start

  /// What contact_h() said last of the symmetric and of the followed motion, for the other harmonics.
  struct Answer {
    std::array<double, 3> at{};  // gamma, tau, restitution; gamma is 0 of none
    bool from_start = false;
    MotionHarmonics h;
  };
  std::array<Answer, 2> answers;
};

/// Of a free contact with damping.
struct ContactShape {
  double damping_ratio;
  double angle;  // its duration times sqrt(k/m)
};
/// @param restitution  in [0, 1]; near 0, where the damping has no bound, taken as 10^-6
[[nodiscard]] ContactShape contact_shape(double restitution);

/// Steady motions of free masses whose contacts take time, over the free contact's restitution and the angle
/// tau = omega times its duration.  tau = 0 is the restitution of the hard contact, and everything tends to that in
/// first order of tau, so that a scene with hard contacts is a scene of contact time 0.
class ContactMotions {
 public:
  /// @param restitution  as contact_shape()
  /// @param harmonics    the highest that is asked for: 1, 3 or 5
  explicit ContactMotions(double restitution, int harmonics = 1);

  /// h of the symmetric orbit of two contacts per period.  Empty where there is none of two simple contacts.
  /// @param tau  > 0
  [[nodiscard]] MotionHarmonics symmetric(double gamma, double tau, FoundMotions& found) const;

  /// h of the stable orbit of one period, of any contacts, that was found last or, from_start, that is beside the
  /// symmetric one found where that has just lost its stability, or that contact at rest leads to.
  /// @param tau  > 0
  [[nodiscard]] MotionHarmonics followed(double gamma, double tau, FoundMotions& found, bool from_start) const;

  [[nodiscard]] double restitution() const noexcept { return restitution_; }
  [[nodiscard]] int harmonics() const noexcept { return harmonics_; }

 private:
  [[nodiscard]] std::optional<SymmetricCompliantOrbit> from_hard(const CompliantGroups& groups) const;
  [[nodiscard]] std::optional<SymmetricCompliantOrbit> at_hard_gamma(const CompliantGroups& groups) const;
  [[nodiscard]] CompliantGroups groups(double gamma, double tau) const;

  double restitution_;
  int harmonics_;
  ContactShape shape_;
};

/// h of the symmetric orbit, or of the orbit followed().  Near tau = 0 interpolated from the hard motion.  One motion
/// is solved for once, whichever harmonics of it are asked for.
/// @param tau  >= 0
[[nodiscard]] const MotionHarmonics& contact_h(const ContactMotions& motions, double gamma, double tau,
                                               bool is_followed, FoundMotions& found, bool from_start);

/// The same over a neighbourhood.
class ContactResponses {
 public:
  /// As ContactMotions.
  explicit ContactResponses(double restitution, int harmonics = 1);
  /// Of the harmonics 1, 3 and 5.
  using All = std::array<std::optional<GapResponse>, 3>;
  /// With derivatives by differences, to four or five digits.  Empty where the motion, or one of a neighbour, does not
  /// exist.
  [[nodiscard]] All at(double gamma, double tau, bool is_followed, FoundMotions found) const;

 private:
  ContactMotions here_, beside_;
};

}  // namespace backlash::detail
