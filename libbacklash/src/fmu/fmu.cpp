// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/fmu.hpp"

#include <limits>

#include "fmu/fmu_text.hpp"
#include "fmu/two_mass_text.hpp"

namespace backlash {

frac::Fmu fmu(const TwoMassSystem& system, const TwoMassState& start, const frac::FmuOptions& options) {
  // Checks the start.
  [[maybe_unused]] const TwoMassPlant plant(system, start);
  using Role = frac::FmuVariable::Role;
  const auto parameter = [](const char* name, const char* description, const char* unit, double value) {
    return frac::FmuVariable{name, Role::fixed_parameter, description, unit, value};
  };
  const frac::detail::FmuParts parts{
      .variables = {{"force", Role::input, "Force on mass 2, constant within a step", "N"},
                    {"position1", Role::output, "Position of mass 1", "m"},
                    {"velocity1", Role::output, "Velocity of mass 1", "m/s"},
                    {"position2", Role::output, "Position of mass 2", "m"},
                    {"velocity2", Role::output, "Velocity of mass 2", "m/s"},
                    {"gap", Role::output, "position2 - position1, from 0 to the clearance", "m"},
                    {"energy_loss", Role::output, "Lost in impacts since the start", "J"},
                    {"impacts", Role::output, "Number of impacts since the start; a completed chatter counts as one"},
                    parameter("mass1", "Mass 1", "kg", system.mass1()),
                    parameter("mass2", "Mass 2, inside the clearance of mass 1", "kg", system.mass2()),
                    parameter("clearance", "Clearance", "m", system.clearance()),
                    parameter("restitution", "Coefficient of restitution", "", system.restitution()),
                    parameter("start_position1", "Position of mass 1 at the start", "m", start.position1),
                    parameter("start_velocity1", "Velocity of mass 1 at the start", "m/s", start.velocity1),
                    parameter("start_position2", "Position of mass 2 at the start", "m", start.position2),
                    parameter("start_velocity2", "Velocity of mass 2 at the start", "m/s", start.velocity2),
                    {.name = "in_contact",
                     .role = Role::output,
                     .description = "The masses touch and do not part under the last force",
                     .is_boolean = true}},
      .states = 4,
      .events = 3,
      .sample_time = std::numeric_limits<double>::quiet_NaN(),
      .values = {},
      .includes = {{"two_mass_model.h", detail::fmu_runtime::two_mass_model}}};
  return frac::detail::fmu_of(parts, options);
}

}  // namespace backlash
