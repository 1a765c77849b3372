// SPDX-License-Identifier: BSD-3-Clause
#include <optional>
#include <string>

#include "arrays.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict cycle_of(const backlash::SymmetricCycle& cycle) {
  py::list harmonics;
  for (const auto& each : cycle.harmonics) harmonics.append(py::make_tuple(each.order, each.x1, each.x2, each.force));
  py::dict result;
  result["omega"] = cycle.omega;
  result["impact_speed"] = cycle.impact_speed;
  result["admissible"] = cycle.admissible;
  result["reason"] = cycle.reason;
  result["stable"] = cycle.stability.stable;
  result["unstable_multipliers"] = cycle.stability.unstable_multipliers;
  result["dominant_multiplier"] = cycle.stability.dominant;
  result["stability_loss"] = std::string(backlash::to_string(cycle.stability.loss));
  result["harmonics"] = harmonics;
  return result;
}

py::dict cycles(const frac::FractionalTransferFunction& controller, double mass1, double mass2, double clearance,
                double restitution, const std::string& body, const std::optional<std::pair<double, double>>& range,
                int harmonics) {
  const backlash::ControlLoop loop({mass1, mass2, clearance, restitution}, controller,
                                   backlash::output_from_string(body));
  backlash::LimitCycleOptions options;
  if (range) options.range = backlash::FrequencyRange{range->first, range->second};
  options.harmonics = harmonics;
  const auto [exact, predicted] = result_of([&](frac::Progress&) {
    return std::pair(backlash::symmetric_cycles(loop, options), backlash::predicted_limit_cycles(loop, options.range));
  });
  py::list found, expected;
  for (const auto& cycle : exact.cycles) found.append(cycle_of(cycle));
  for (const auto& cycle : predicted) {
    py::dict entry;
    entry["omega"] = cycle.omega;
    entry["force_amplitude"] = cycle.force_amplitude;
    entry["faster_orbit"] = cycle.faster_orbit;
    entry["stable"] = cycle.stable;
    entry["third_harmonic"] = cycle.third_harmonic;
    entry["second_harmonic"] = cycle.second_harmonic;
    entry["symmetric"] = cycle.symmetric;
    entry["admissible"] = cycle.admissible;
    expected.append(entry);
  }
  py::dict result;
  result["cycles"] = found;
  result["predicted"] = expected;
  result["searched"] = py::make_tuple(exact.searched.from, exact.searched.to);
  result["certain"] = exact.certain;
  result["any_frequency"] = exact.any_frequency;
  return result;
}

}  // namespace

void add_loops(py::module_& module) {
  module.def("limit_cycles", &cycles);
}

}  // namespace python
