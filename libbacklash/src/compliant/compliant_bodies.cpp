// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_bodies.hpp"

#include <utility>

#include "base/check.hpp"

namespace backlash {
namespace {

LinearBodies hard_bodies(frac::FractionalTransferFunction load, frac::FractionalTransferFunction drive,
                         double clearance, const CompliantContact& contact) {
  detail::require_positive("clearance", "m", clearance);
  // The masses are known once the receptances are read.
  const LinearBodies elastic(load, drive, clearance, 1);
  const double restitution = free_contact(contact, elastic.system().mass1(), elastic.system().mass2()).restitution;
  return {std::move(load), std::move(drive), clearance, restitution};
}

}  // namespace

CompliantBodies::CompliantBodies(frac::FractionalTransferFunction load, frac::FractionalTransferFunction drive,
                                 double clearance, const CompliantContact& contact, const CoulombFriction& friction)
    : contact_(contact),
      friction_(friction),
      hard_(hard_bodies(std::move(load), std::move(drive), clearance, contact)) {
  detail::require_not_negative("friction1", "N", friction.body1);
  detail::require_not_negative("friction2", "N", friction.body2);
}

}  // namespace backlash
