// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/tune.hpp"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "arrays.hpp"
#include "backlash/design/tune_with_backlash.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/plants_of_record.hpp"
#include "frac/identification/robust_tune.hpp"
#include "loop_parts.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

using Pair = std::pair<double, double>;

frac::LoopSpecification specification_of(const py::dict& given) {
  const auto bound = [&](const char* key) -> std::optional<frac::GainBound> {
    if (given[key].is_none()) return std::nullopt;
    const auto [omega, gain] = given[key].cast<Pair>();
    return frac::GainBound{omega, gain};
  };
  frac::LoopSpecification asked;
  asked.crossover = given["crossover"].cast<std::optional<double>>();
  asked.phase_margin = given["phase_margin"].cast<std::optional<double>>();
  asked.flat_phase = given["flat_phase"].cast<bool>();
  asked.max_sensitivity = given["max_sensitivity"].cast<double>();
  asked.max_complementary_sensitivity = given["max_complementary_sensitivity"].cast<double>();
  asked.high_frequency = bound("high_frequency");
  asked.low_frequency = bound("low_frequency");
  return asked;
}

frac::TuningOptions options_of(const py::dict& given) {
  const auto range = [&](const char* key) {
    const auto [lower, upper] = given[key].cast<Pair>();
    return frac::OrderRange{lower, upper};
  };
  frac::TuningOptions options;
  options.structure = frac::controller_structure_from_string(given["structure"].cast<std::string>());
  options.lambda = range("lambda_");
  options.mu = range("mu");
  options.derivative_filter_time = given["derivative_filter_time"].cast<double>();
  options.criterion = frac::tuning_criterion_from_string(given["minimise"].cast<std::string>());
  options.load_step = given["load_step"].cast<bool>();
  options.horizon = given["horizon"].cast<double>();
  options.seed = given["seed"].cast<std::uint64_t>();
  return options;
}

py::dict dict_of_tuning(const frac::TuningResult& found) {
  py::dict dict = dict_of(found);
  dict["usable"] = found.usable();
  dict["summary"] = found.summary();
  py::list lines;
  for (const auto& line : found.specification)
    lines.append(py::make_tuple(line.name, line.asked, line.reached, line.met));
  dict["specification"] = lines;
  dict["controller"] = frac::controller_transfer_function(found.gains, found.derivative_filter_time).formula();
  return dict;
}

py::dict tuned(const frac::FractionalTransferFunction& plant, const py::dict& specification, const py::dict& given) {
  const frac::LoopSpecification asked = specification_of(specification);
  const frac::TuningOptions options = options_of(given);
  return dict_of_tuning(result_of([&](frac::Progress&) { return frac::tune(plant, asked, options); }));
}

py::dict dict_of_region(const frac::RobustTuningResult& found) {
  py::dict dict = dict_of_tuning(found.nominal);
  py::dict region = dict_of(found);
  region.attr("pop")("nominal");
  dict["region"] = region;
  // The answer is that of all plants of the region.
  dict["status"] = region["status"];
  dict["message"] = found.message;
  dict["summary"] = found.summary();
  dict["usable"] = found.usable();
  return dict;
}

py::dict tuned_for_region(const py::dict& fit, const py::dict& specification, const py::dict& given) {
  const frac::LoopSpecification asked = specification_of(specification);
  const frac::TuningOptions options = options_of(given);
  const frac::FitResult plants = fit_result_from(fit);
  return dict_of_region(result_of([&](frac::Progress&) { return frac::tune_for_region(plants, asked, options); }));
}

py::dict tuned_from_relay(const py::dict& data, const py::dict& specification, const py::dict& given) {
  const frac::LoopSpecification asked = specification_of(specification);
  const frac::TuningOptions options = options_of(given);
  const frac::TimeResponseData record = record_of(data);
  const auto [plants, found] = result_of([&](frac::Progress&) {
    auto possible = frac::plants_of_record(record);
    if (!possible)
      throw std::invalid_argument(
          "the record shows no plant: neither a lag nor a second order with dead time follows it");
    auto region = frac::tune_for_region(possible->best, asked, options, possible->others);
    return std::pair(*possible, region);
  });
  py::dict dict = dict_of_region(found);
  dict["plant"] = frac::fitted_plant(plants.best).formula();
  if (plants.misfit.empty()) return dict;
  // The region tells nothing of a plant that does not follow the record.
  dict["status"] = std::string(frac::to_string(frac::TuningStatus::not_met));
  dict["message"] = found.message + " " + plants.misfit;
  dict["summary"] = found.summary() + " " + plants.misfit;
  dict["usable"] = false;
  return dict;
}

py::dict dict_of_motion(const backlash::PersistentMotion& motion) {
  py::list cycles, simulations;
  for (const auto& cycle : motion.cycles) cycles.append(cycle_of(cycle));
  for (const auto& cycle : motion.further) cycles.append(cycle_of(cycle));
  for (const auto& cycle : motion.compliant) cycles.append(cycle_of(cycle));
  for (const auto& each : motion.simulations)
    simulations.append(py::dict(py::arg("velocity2") = each.speed, py::arg("swing") = each.swing,
                                py::arg("dies_out") = each.dies_out));
  return py::dict(py::arg("swing") = motion.swing, py::arg("omega") = motion.omega,
                  py::arg("verified") = motion.verified, py::arg("certain") = motion.certain,
                  py::arg("searched") = py::make_tuple(motion.searched.from, motion.searched.to),
                  py::arg("cycles") = cycles, py::arg("simulations") = simulations);
}

py::dict tuned_with_backlash(const py::dict& bodies, const py::dict& specification, const py::dict& given) {
  const frac::LoopSpecification asked = specification_of(specification);
  const frac::TuningOptions options = options_of(given);
  const auto compliant = compliant_of(bodies);
  const backlash::BacklashPlant plant{compliant ? compliant->hard() : bodies_of(bodies), body_of(bodies), compliant};
  const auto found = result_of([&](frac::Progress&) { return backlash::tune_with_backlash(plant, asked, options); });
  py::dict dict = dict_of_tuning(found.linear);
  dict["message"] = found.message;
  dict["summary"] = found.summary();
  dict["usable"] = found.usable();
  dict["motion"] = dict_of_motion(found.persistent);
  dict["regardless"] = dict_of_tuning(found.regardless);
  dict["motion_regardless"] = dict_of_motion(found.of_regardless);
  py::list constraints;
  for (const auto& line : found.constraints)
    constraints.append(py::dict(py::arg("name") = line.name, py::arg("asked") = line.asked,
                                py::arg("reached") = line.reached, py::arg("active") = line.active));
  dict["constraints"] = constraints;
  return dict;
}

}  // namespace

void add_tune(py::module_& module) {
  module.attr("described")["Tuning"] = attributes_of<frac::TuningResult>();
  module.def("tune", &tuned);
  module.def("tune_for_region", &tuned_for_region);
  module.def("tune_from_relay", &tuned_from_relay);
  module.def("tune_with_backlash", &tuned_with_backlash);
}

}  // namespace python
