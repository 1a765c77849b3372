// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/linear_bodies.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "frac/model/algebra.hpp"

namespace backlash {
namespace {

// 1/(s^2 G) at high frequency.
double mass_of(const frac::FractionalTransferFunction& receptance, const std::string& which) {
  if (receptance.delay() > 0) {
    throw std::invalid_argument("the receptance of the " + which +
                                " has a dead time; a body answers to a force at once");
  }
  const frac::PowerTerm& top = receptance.numerator().front();
  const frac::PowerTerm& bottom = receptance.denominator().front();
  const double fall = bottom.order - top.order;
  const double mass = bottom.coefficient / top.coefficient;
  if (std::abs(fall - 2) > 1e-12) {
    throw std::invalid_argument(
        "the receptance of the " + which + " falls as s^" + detail::text(0 - fall) +
        " at high frequency; it must fall as 1/(M s^2), M its mass, as otherwise " +
        (fall < 2 ? "an impulse would throw it at infinite speed" : "no impulse would change its velocity"));
  }
  if (!(mass > 0)) {
    throw std::invalid_argument("the receptance of the " + which +
                                " falls as 1/(M s^2) with M = " + detail::text(mass) + " kg; a mass is > 0");
  }
  return mass;
}

bool is_free(const frac::FractionalTransferFunction& receptance) {
  return receptance.numerator().size() == 1 && receptance.denominator().size() == 1;
}

}  // namespace

frac::FractionalTransferFunction free_mass(double mass) {
  detail::require_positive("mass", "kg", mass);
  return {{{1 / mass, 0}}, {{1, 2}}};
}

frac::FractionalTransferFunction rigid_receptance(const LinearBodies& bodies) {
  if (bodies.are_free()) return free_mass(bodies.system().mass1() + bodies.system().mass2());
  return frac::simplified(bodies.load() * bodies.drive() / (bodies.load() + bodies.drive()));
}

LinearBodies::LinearBodies(const TwoMassSystem& system)
    : system_(system),
      load_(free_mass(system.mass1())),
      drive_(free_mass(system.mass2())),
      has_free_load_(true),
      has_free_drive_(true) {}

LinearBodies::LinearBodies(frac::FractionalTransferFunction load, frac::FractionalTransferFunction drive,
                           double clearance, double restitution)
    : system_(mass_of(load, "load"), mass_of(drive, "driven body"), clearance, restitution),
      load_(std::move(load)),
      drive_(std::move(drive)),
      has_free_load_(is_free(load_)),
      has_free_drive_(is_free(drive_)) {}

}  // namespace backlash
