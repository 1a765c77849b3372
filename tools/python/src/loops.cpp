// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>
#include <optional>
#include <string>
#include <tuple>

#include "arrays.hpp"
#include "backlash/loops/describe.hpp"
#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "described.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict cycle_of(double omega, bool symmetric, std::size_t impacts, double speed, bool admissible,
                  const std::string& reason, const backlash::CycleStability& stability,
                  const std::vector<backlash::CycleHarmonic>& of_motion) {
  py::list harmonics;
  for (const auto& each : of_motion) harmonics.append(py::make_tuple(each.order, each.x1, each.x2, each.force));
  py::dict result;
  result["omega"] = omega;
  result["symmetric"] = symmetric;
  result["impacts_per_period"] = impacts;
  result["impact_speed"] = speed;
  result["admissible"] = admissible;
  result["reason"] = reason;
  result["stable"] = stability.stable;
  result["unstable_multipliers"] = stability.unstable_multipliers;
  result["dominant_multiplier"] = stability.dominant;
  result["stability_loss"] = std::string(backlash::to_string(stability.loss));
  result["harmonics"] = harmonics;
  return result;
}

using Receptance = std::optional<frac::FractionalTransferFunction>;

// A mass has no meaning beside its receptance.
backlash::LinearBodies bodies_of(const std::optional<double>& mass1, const std::optional<double>& mass2,
                                 const Receptance& load, const Receptance& drive, double clearance,
                                 double restitution) {
  if (mass1 && load) throw std::invalid_argument("mass1 does not go with load_receptance: the mass is that in it");
  if (mass2 && drive) throw std::invalid_argument("mass2 does not go with drive_receptance: the mass is that in it");
  const double m1 = mass1.value_or(1), m2 = mass2.value_or(1);
  if (!load && !drive) return backlash::TwoMassSystem(m1, m2, clearance, restitution);
  return {load ? *load : backlash::free_mass(m1), drive ? *drive : backlash::free_mass(m2), clearance, restitution};
}

py::dict cycles(const frac::FractionalTransferFunction& controller, const std::optional<double>& mass1,
                const std::optional<double>& mass2, const Receptance& load, const Receptance& drive, double clearance,
                double restitution, const std::string& body, const std::optional<std::pair<double, double>>& range,
                int harmonics, int starts) {
  const backlash::ControlLoop loop(bodies_of(mass1, mass2, load, drive, clearance, restitution), controller,
                                   backlash::output_from_string(body));
  backlash::LimitCycleOptions options;
  if (range) options.range = backlash::FrequencyRange{range->first, range->second};
  options.harmonics = harmonics;
  backlash::ImpactCycleOptions seeded;
  seeded.starts = starts;
  seeded.harmonics = harmonics;
  const bool can_start = loop.measured() == backlash::Output::x1 || loop.controller().delay() == 0;
  const auto [exact, predicted, settled] = result_of([&](frac::Progress&) {
    return std::tuple(backlash::symmetric_cycles(loop, options), backlash::predicted_limit_cycles(loop, options.range),
                      can_start && starts > 0 ? backlash::impact_cycles(loop, seeded) : backlash::ImpactCycles{});
  });
  py::list found;
  for (const auto& cycle : exact.cycles)
    found.append(cycle_of(cycle.omega, true, 2, cycle.impact_speed, cycle.admissible, cycle.reason, cycle.stability,
                          cycle.harmonics));
  for (const auto* cycle : backlash::further_cycles(settled.cycles, exact.cycles))
    found.append(cycle_of(2 * std::numbers::pi / cycle->period, cycle->symmetric, cycle->impacts.size(),
                          cycle->impacts.front().speed, cycle->admissible, cycle->reason, cycle->stability,
                          cycle->harmonics));
  py::list motions;
  for (const auto& motion : settled.motions) motions.append(std::string(backlash::to_string(motion.regime)));
  py::dict result;
  result["cycles"] = found;
  result["predicted"] = object_of(predicted);
  result["motions"] = motions;
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
