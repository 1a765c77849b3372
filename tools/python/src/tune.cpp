// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/tune.hpp"

#include <optional>
#include <string>

#include "arrays.hpp"
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

py::dict tuned(const frac::FractionalTransferFunction& plant, const py::dict& specification, const py::dict& given) {
  const frac::LoopSpecification asked = specification_of(specification);
  const frac::TuningOptions options = options_of(given);
  const auto found = result_of([&](frac::Progress&) { return frac::tune(plant, asked, options); });
  py::dict dict;
  dict["kp"] = found.gains.kp;
  dict["ki"] = found.gains.ki;
  dict["kd"] = found.gains.kd;
  dict["lambda_"] = found.gains.lambda;
  dict["mu"] = found.gains.mu;
  dict["derivative_filter_time"] = found.derivative_filter_time;
  dict["status"] = std::string(frac::to_string(found.status));
  dict["usable"] = found.usable();
  dict["message"] = found.message;
  dict["closed_loop"] = std::string(frac::to_string(found.closed_loop));
  dict["crossover"] = found.crossover;
  dict["phase_margin"] = found.phase_margin;
  dict["phase_slope"] = found.phase_slope;
  dict["gain_margin"] = found.gain_margin;
  dict["max_sensitivity"] = found.max_sensitivity;
  dict["max_complementary_sensitivity"] = found.max_complementary_sensitivity;
  dict["iae"] = found.iae;
  dict["itae"] = found.itae;
  dict["evaluations"] = found.evaluations;
  dict["summary"] = found.summary();
  py::list lines;
  for (const auto& line : found.specification)
    lines.append(py::make_tuple(line.name, line.asked, line.reached, line.met));
  dict["specification"] = lines;
  dict["controller"] = frac::controller_transfer_function(found.gains, found.derivative_filter_time).formula();
  return dict;
}

}  // namespace

void add_tune(py::module_& module) {
  module.def("tune", &tuned);
}

}  // namespace python
