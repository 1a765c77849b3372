// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>

#include "compliant/compliant_orbit.hpp"
#include "compliant/symmetric_compliant_orbit.hpp"
#include "scene_response.hpp"

namespace backlash::detail {

/// The motions of one point that were found last, from which Newton's method finds those of a scene nearby.
struct FoundMotions {
  std::optional<SymmetricCompliantOrbit> symmetric;
  std::optional<CompliantOrbit> followed;
  int failures = 0;  // of following the motion from its start
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
  explicit ContactMotions(double restitution);

  /// h of the symmetric orbit of two contacts per period.
  struct Symmetric {
    std::complex<double> h;
    double largest_multiplier;  // below 1: stable
  };
  /// Empty where there is none of two simple contacts.  @param tau  > 0
  /// @param harmonic  1, 3 or 5, here and below
  [[nodiscard]] std::optional<Symmetric> symmetric(double gamma, double tau, int harmonic, FoundMotions& found) const;

  /// h of the stable orbit of one period, of any contacts, that was found last or, from_start, that is beside the
  /// symmetric one found where that has just lost its stability, or that contact at rest leads to.
  /// @param tau  > 0
  [[nodiscard]] std::optional<std::complex<double>> followed(double gamma, double tau, int harmonic,
                                                             FoundMotions& found, bool from_start) const;

  [[nodiscard]] double restitution() const noexcept { return restitution_; }

 private:
  [[nodiscard]] std::optional<SymmetricCompliantOrbit> from_hard(const CompliantGroups& groups) const;
  [[nodiscard]] std::optional<SymmetricCompliantOrbit> at_hard_gamma(const CompliantGroups& groups) const;
  [[nodiscard]] CompliantGroups groups(double gamma, double tau) const;

  double restitution_;
  ContactShape shape_;
};

/// h of the symmetric orbit, or of the orbit followed().  Near tau = 0 interpolated from the hard motion.
/// @param tau  >= 0
[[nodiscard]] std::optional<std::complex<double>> contact_h(const ContactMotions& motions, double gamma, double tau,
                                                            bool is_followed, FoundMotions& found, bool from_start,
                                                            int harmonic = 1);

/// The same over a neighbourhood.
class ContactResponses {
 public:
  /// @param restitution  as contact_shape()
  explicit ContactResponses(double restitution);
  /// With derivatives by differences, to four or five digits.  Empty where the motion, or one of a neighbour, does not
  /// exist.
  [[nodiscard]] std::optional<GapResponse> at(double gamma, double tau, bool is_followed, FoundMotions found,
                                              int harmonic = 1) const;

 private:
  ContactMotions here_, beside_;
};

}  // namespace backlash::detail
