// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant_contact.hpp"

#include <cmath>
#include <stdexcept>

#include "check.hpp"

namespace backlash {
namespace {

// acos(zeta)/sqrt(1 - zeta^2), continued above 1 by acosh(zeta)/sqrt(zeta^2 - 1): half the time of a free contact
// without its damping, in units of 1/wc.
double half_duration(double zeta) {
  if (zeta < 1) {
    const double root = std::sqrt((1 - zeta) * (1 + zeta));
    return std::atan2(root, zeta) / root;
  }
  // Far above, where the square leaves the range of numbers, zeta itself to rounding.
  const double root = zeta < 1e9 ? std::sqrt((zeta - 1) * (zeta + 1)) : zeta;
  // acosh(zeta) = ln(zeta + root), which is zeta - 1 + root above ln 1.
  return root > 0 ? std::log1p(zeta - 1 + root) / root : 1;
}

double reduced_mass(double mass1, double mass2) {
  return mass1 / (mass1 + mass2) * mass2;
}

}  // namespace

CompliantContact::CompliantContact(double stiffness, double damping) : stiffness_(stiffness), damping_(damping + 0.0) {
  detail::require_positive("contact_stiffness", "N/m", stiffness);
  detail::require_not_negative("contact_damping", "N s/m", damping);
}

CompliantContact CompliantContact::from_frequency(double frequency, double damping_ratio, double mass1, double mass2) {
  detail::require_positive("contact_frequency", "rad/s", frequency);
  detail::require_not_negative("contact_ratio", "", damping_ratio);
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  const double mass = reduced_mass(mass1, mass2);
  return {mass * frequency * frequency, 2 * damping_ratio * mass * frequency};
}

FreeContact free_contact(const CompliantContact& contact, double mass1, double mass2) {
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  const double mass = reduced_mass(mass1, mass2);
  const double frequency = std::sqrt(contact.stiffness() / mass);
  const double ratio = contact.damping() / (2 * mass * frequency);
  return {frequency, ratio, restitution_of_damping_ratio(ratio), 2 * half_duration(ratio) / frequency};
}

double restitution_of_damping_ratio(double damping_ratio) {
  detail::require_not_negative("contact_ratio", "", damping_ratio);
  return std::exp(-2 * damping_ratio * half_duration(damping_ratio));
}

double damping_ratio_of_restitution(double restitution) {
  if (!(restitution > 0 && restitution <= 1))
    throw std::invalid_argument("contact_restitution is " + detail::text(restitution) +
                                "; that of a contact with damping is in (0, 1]");
  // zeta half_duration(zeta) rises from 0 without end, as zeta near 0 and as ln(2 zeta) far above.
  const double loss = -std::log(restitution) / 2;
  if (loss == 0) return 0;
  double low = 0, high = 1;
  while (high * half_duration(high) < loss) high *= 2;
  for (int i = 0; i < 2000 && std::nextafter(low, high) < high; ++i) {
    const double middle = low + (high - low) / 2;
    (middle * half_duration(middle) < loss ? low : high) = middle;
  }
  return high;
}

}  // namespace backlash
