// SPDX-License-Identifier: BSD-3-Clause
#include "output/scene_export.hpp"

#include <cassert>

#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "report/html.hpp"

namespace fracfit {
namespace {

std::string options_of(const backlash::TwoMassSystem& system, const std::optional<backlash::CompliantContact>& contact,
                       const backlash::CoulombFriction& friction) {
  std::string text;
  const auto add = [&](const char* name, double value) {
    text += (text.empty() ? "" : " ") + std::string(name) + " " + io::format_number(value);
  };
  add("--mass1", system.mass1());
  add("--mass2", system.mass2());
  add("--clearance", system.clearance());
  if (!contact) {
    add("--restitution", system.restitution());
    return text + "\n";
  }
  add("--contact-stiffness", contact->stiffness());
  add("--contact-damping", contact->damping());
  if (friction.body1 != 0) add("--friction1", friction.body1);
  if (friction.body2 != 0) add("--friction2", friction.body2);
  return text + "\n";
}

// ElastoBacklash2 presses c d + d d' at the overlap d and does not pull: the same contact.
std::string modelica_of(const backlash::TwoMassSystem& system, const backlash::CompliantContact& contact,
                        const backlash::CoulombFriction& friction, const std::string& command) {
  const std::string components = "  Modelica.Mechanics.Rotational.Components.";
  std::string text = "// " + command + "\nmodel Backlash \"Two inertias with backlash\"\n" + components +
                     "Inertia load(J = " + io::format_number(system.mass1()) + ");\n" + components +
                     "Inertia motor(J = " + io::format_number(system.mass2()) + ");\n" + components +
                     "ElastoBacklash2 gap(b = " + io::format_number(system.clearance()) +
                     ", c = " + io::format_number(contact.stiffness()) +
                     ", d = " + io::format_number(contact.damping()) + ", phi_rel0 = 0);\n";
  std::string joints;
  const auto add_friction = [&](const char* name, const char* body, double torque) {
    if (torque == 0) return;
    text += components + "BearingFriction " + name + "(tau_pos = [0, " + io::format_number(torque) + "]);\n";
    joints += std::string("  connect(") + body + ".flange_b, " + name + ".flange_a);\n";
  };
  add_friction("friction1", "load", friction.body1);
  add_friction("friction2", "motor", friction.body2);
  return text +
         "  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange \"Of the motor\";\nequation\n"
         "  connect(flange, motor.flange_a);\n  connect(motor.flange_b, gap.flange_a);\n"
         "  connect(gap.flange_b, load.flange_a);\n" +
         joints + "end Backlash;\n";
}

// With the impedance p MuJoCo's limit presses m p/(1 - p) (B v + K p d - a): B and K p are -solref over p.  The rest is
// p/(1 - p) of the reduced mass m that moves with the contact, at the least impedance that MuJoCo takes.
std::string mjcf_of(const backlash::TwoMassSystem& system, const backlash::CompliantContact& contact,
                    const backlash::CoulombFriction& friction, const std::string& command) {
  constexpr double impedance = 1e-4;
  const double per_mass = (1 - impedance) * (1 / system.mass1() + 1 / system.mass2());
  const auto number = [](double value) { return io::format_number(value); };
  const auto body = [&](const char* name, double inertia, double torque) {
    const std::string j = number(inertia), named = std::string(" name=\"") + name + "\"";
    return "    <body" + named + ">\n      <joint" + named + " axis=\"0 0 1\"" +
           (torque == 0 ? "" : " frictionloss=\"" + number(torque) + "\"") +
           "/>\n      <inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\"" + j + " " + j + " " + j +
           "\"/>\n    </body>\n";
  };
  const std::string half = number(0.5 * system.clearance()), p = number(impedance);
  // Twenty steps in a radian of the contact.
  const double frequency = backlash::free_contact(contact, system.mass1(), system.mass2()).frequency;
  return "<mujoco model=\"backlash\">\n  <option integrator=\"RK4\" timestep=\"" + short_number(0.05 / frequency, 2) +
         "\"/>\n  <custom>\n    <text name=\"command\" data=\"" + report::escape_html(command) +
         "\"/>\n  </custom>\n  <worldbody>\n" + body("load", system.mass1(), friction.body1) +
         body("motor", system.mass2(), friction.body2) +
         "  </worldbody>\n  <tendon>\n    <fixed name=\"gap\" limited=\"true\" range=\"-" + half + " " + half +
         "\" solreflimit=\"" + number(-contact.stiffness() * per_mass) + " " + number(-contact.damping() * per_mass) +
         "\" solimplimit=\"" + p + " " + p +
         " 1\">\n      <joint joint=\"motor\" coef=\"1\"/>\n      <joint joint=\"load\" coef=\"-1\"/>\n"
         "    </fixed>\n  </tendon>\n  <actuator>\n    <motor name=\"motor\" joint=\"motor\"/>\n  </actuator>\n"
         "</mujoco>\n";
}

}  // namespace

std::string_view to_string(SceneWords words) {
  return words == SceneWords::options ? "options" : words == SceneWords::modelica ? "modelica" : "mjcf";
}

std::string scene_in(SceneWords words, const backlash::TwoMassSystem& system,
                     const std::optional<backlash::CompliantContact>& contact,
                     const backlash::CoulombFriction& friction, const std::string& command) {
  if (words == SceneWords::options) return options_of(system, contact, friction);
  assert(contact);
  return words == SceneWords::modelica ? modelica_of(system, *contact, friction, command)
                                       : mjcf_of(system, *contact, friction, command);
}

}  // namespace fracfit
