// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <optional>
#include <string>

#include "arrays.hpp"
#include "backlash/compliant/compliant_orbits.hpp"
#include "backlash/orbit_continuation.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict branch_of(const backlash::OrbitBranch& branch) {
  const auto& orbits = branch.orbits;
  std::vector<std::complex<double>> multipliers;
  for (const auto& orbit : orbits)
    multipliers.insert(multipliers.end(), orbit.multipliers.begin(), orbit.multipliers.end());
  py::list bifurcations;
  for (const auto& each : branch.bifurcations) {
    py::dict entry;
    entry["kind"] = std::string(backlash::to_string(each.kind));
    entry["parameter"] = each.orbit.parameter;
    entry["response"] = each.orbit.value;
    entry["after"] = each.after;
    bifurcations.append(entry);
  }
  py::dict result;
  result["period"] = branch.period;
  result["impacts"] = branch.impacts;
  result["symmetric"] = branch.symmetric;
  result["parameter"] = column_of<double>(orbits, [](const auto& orbit) { return orbit.parameter; });
  result["omega"] = column_of<double>(orbits, [](const auto& orbit) { return orbit.omega; });
  result["response"] = column_of<std::complex<double>>(orbits, [](const auto& orbit) { return orbit.value; });
  result["stable"] = column_of<bool>(orbits, [](const auto& orbit) { return orbit.stable; });
  result["multipliers"] = array_of(std::move(multipliers), {static_cast<py::ssize_t>(orbits.size()), 2});
  result["bifurcations"] = bifurcations;
  result["begin"] = std::string(backlash::to_string(branch.begin));
  result["end"] = std::string(backlash::to_string(branch.end));
  return result;
}

// contact: stiffness, damping, and the friction of both masses, in place of the restitution.
py::list branches(double mass1, double mass2, double clearance, double restitution, double force, double omega,
                  const std::string& parameter, double from, double to, const std::string& body, int longest_period,
                  int most_impacts, const Reals& basins_at, int threads,
                  const std::optional<std::array<double, 4>>& contact, const py::object& report) {
  const auto chosen = backlash::orbit_parameter_from_string(parameter);
  const backlash::OrbitContinuationOptions options{backlash::output_from_string(body), longest_period, most_impacts,
                                                   threads, vector_of(basins_at)};
  const auto diagram = result_of(
      [&](frac::Progress& progress) {
        if (!contact)
          return backlash::orbit_diagram({mass1, mass2, clearance, restitution}, force, omega, chosen, from, to,
                                         options, &progress);
        const auto [stiffness, damping, friction1, friction2] = *contact;
        const backlash::CompliantBodies bodies(backlash::free_mass(mass1), backlash::free_mass(mass2), clearance,
                                               backlash::CompliantContact(stiffness, damping), {friction1, friction2});
        return backlash::orbit_diagram(bodies, force, omega, chosen, from, to, options, &progress);
      },
      report);
  py::list list;
  for (const auto& branch : diagram.branches) list.append(branch_of(branch));
  return list;
}

}  // namespace

void add_orbits(py::module_& module) {
  module.def("orbits", &branches);
}

}  // namespace python
