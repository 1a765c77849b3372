// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <numbers>
#include <optional>
#include <string>

#include "backlash/compliant/compliant_cycles.hpp"
#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/describe.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "described.hpp"

namespace python {

/// Two bodies with clearance from a dict: mass1, mass2, load_receptance, drive_receptance (None where not given),
/// clearance, restitution.
/// @throws std::invalid_argument  a mass beside the receptance that it is in; as LinearBodies.
[[nodiscard]] inline backlash::LinearBodies bodies_of(const pybind11::dict& given) {
  using Receptance = std::optional<frac::FractionalTransferFunction>;
  const auto mass1 = given["mass1"].cast<std::optional<double>>(), mass2 = given["mass2"].cast<std::optional<double>>();
  const auto load = given["load_receptance"].cast<Receptance>(), drive = given["drive_receptance"].cast<Receptance>();
  const auto clearance = given["clearance"].cast<double>(), restitution = given["restitution"].cast<double>();
  if (mass1 && load) throw std::invalid_argument("mass1 does not go with load_receptance: the mass is that in it");
  if (mass2 && drive) throw std::invalid_argument("mass2 does not go with drive_receptance: the mass is that in it");
  const double m1 = mass1.value_or(1), m2 = mass2.value_or(1);
  if (!load && !drive) return backlash::TwoMassSystem(m1, m2, clearance, restitution);
  return {load ? *load : backlash::free_mass(m1), drive ? *drive : backlash::free_mass(m2), clearance, restitution};
}

/// With a contact that has a stiffness and a damping, and dry friction, in place of that restitution: the key "contact"
/// has these two and the friction of both bodies, or None.
[[nodiscard]] inline std::optional<backlash::CompliantBodies> compliant_of(const pybind11::dict& given) {
  if (given["contact"].is_none()) return std::nullopt;
  const auto [stiffness, damping, friction1, friction2] = given["contact"].cast<std::array<double, 4>>();
  const backlash::LinearBodies hard = bodies_of(given);
  return backlash::CompliantBodies(hard.load(), hard.drive(), hard.system().clearance(),
                                   backlash::CompliantContact(stiffness, damping), {friction1, friction2});
}

/// The measured body, by the key "body".
[[nodiscard]] inline backlash::Output body_of(const pybind11::dict& given) {
  return backlash::output_from_string(given["body"].cast<std::string>());
}

/// The loop that a controller closes around them.
[[nodiscard]] inline backlash::ControlLoop loop_of(const frac::FractionalTransferFunction& controller,
                                                   const pybind11::dict& given) {
  return {bodies_of(given), controller, body_of(given)};
}

/// A cycle of any kind as a dict.
template <class Cycle>
[[nodiscard]] pybind11::dict cycle_of(const Cycle& cycle) {
  pybind11::dict result;
  result["admissible"] = true;
  result["reason"] = "";
  if constexpr (requires { cycle.sticks; }) {
    result["omega"] = cycle.omega;
    result["symmetric"] = cycle.symmetric;
    result["impacts_per_period"] = cycle.contacts;
    result["sticks_per_period"] = cycle.sticks;
    result["impact_speed"] = cycle.impact_speed;
  } else if constexpr (requires { cycle.period; }) {
    result["omega"] = 2 * std::numbers::pi / cycle.period;
    result["symmetric"] = cycle.symmetric;
    result["impacts_per_period"] = cycle.impacts.size();
    result["impact_speed"] = cycle.impacts.front().speed;
  } else {
    result["omega"] = cycle.omega;
    result["symmetric"] = true;
    result["impacts_per_period"] = 2;
    result["impact_speed"] = cycle.impact_speed;
  }
  if constexpr (requires { cycle.admissible; }) {
    result["admissible"] = cycle.admissible;
    result["reason"] = cycle.reason;
  }
  result["stable"] = cycle.stability.stable;
  result["unstable_multipliers"] = cycle.stability.unstable_multipliers;
  result["dominant_multiplier"] = cycle.stability.dominant;
  result["stability_loss"] = std::string(backlash::to_string(cycle.stability.loss));
  pybind11::list harmonics;
  for (const auto& each : cycle.harmonics)
    harmonics.append(pybind11::make_tuple(each.order, each.x1, each.x2, each.force));
  result["harmonics"] = harmonics;
  return result;
}

}  // namespace python
