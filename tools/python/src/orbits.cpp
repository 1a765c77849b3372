// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "arrays.hpp"
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

py::list branches(double mass1, double mass2, double clearance, double restitution, double force, double omega,
                  const std::string& parameter, double from, double to, const std::string& body, int longest_period,
                  int most_impacts, const Reals& basins_at, int threads, const py::object& report) {
  const backlash::TwoMassSystem system(mass1, mass2, clearance, restitution);
  const auto chosen = backlash::orbit_parameter_from_string(parameter);
  const backlash::OrbitContinuationOptions options{backlash::output_from_string(body), longest_period, most_impacts,
                                                   threads, vector_of(basins_at)};
  const auto diagram = result_of(
      [&](frac::Progress& progress) {
        return backlash::orbit_diagram(system, force, omega, chosen, from, to, options, &progress);
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
