// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "arrays.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "fit_request.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of(const backlash::SceneEstimate& estimate) {
  py::dict dict;
  dict["name"] = estimate.name;
  dict["unit"] = estimate.unit;
  dict["value"] = estimate.value;
  dict["standard_error"] = estimate.standard_error;
  dict["ci95_lower"] = estimate.ci95_lower;
  dict["ci95_upper"] = estimate.ci95_upper;
  dict["fixed"] = estimate.fixed;
  dict["at_bound"] = estimate.at_bound;
  dict["identified"] = estimate.identified;
  return dict;
}

template <typename Estimates>
py::list list_of_estimates(const Estimates& estimates) {
  py::list list;
  for (const auto& each : estimates) list.append(dict_of(each));
  return list;
}

py::dict identified(const py::list& curves, const std::vector<double>& forces, const py::dict& given) {
  std::vector<backlash::MeasuredDescribingFunction> measured;
  for (std::size_t i = 0; i < forces.size(); ++i)
    measured.push_back({spectrum_of(curves[i].cast<py::dict>()), forces[i]});
  backlash::SceneIdentificationOptions options;
  options.output = backlash::output_from_string(given["body"].cast<std::string>());
  options.component = frac::component_from_string(given["component"].cast<std::string>());
  options.weight = frac::weight_from_string(given["weight"].cast<std::string>());
  options.constraints = constraints_of({}, given);
  options.threads = given["threads"].cast<int>();
  const auto found = result_of([&](frac::Progress&) { return backlash::identify_scene(measured, options); });
  py::dict dict;
  dict["parameters"] = list_of_estimates(found.parameters);
  dict["combinations"] = list_of_estimates(found.combinations);
  dict["free_directions"] = found.free_directions;
  dict["points_used"] = found.points_used;
  dict["points"] = found.points.size();
  dict["curve"] = column_of<std::int64_t>(found.points, [](const auto& point) { return point.curve; });
  dict["omega"] = column_of<double>(found.points, [](const auto& point) { return point.omega; });
  dict["used"] =
      column_of<bool>(found.points, [](const auto& point) { return point.status == backlash::PointStatus::used; });
  dict["response"] = column_of<std::complex<double>>(found.points, [](const auto& point) { return point.model; });
  dict["covariance"] = found.covariance;
  dict["rms"] = found.rms;
  dict["cost"] = found.cost;
  dict["termination"] = std::string(frac::to_string(found.termination));
  dict["usable"] = found.termination == frac::FitTermination::converged;
  dict["message"] = found.message;
  return dict;
}

}  // namespace

void add_scene(py::module_& module) {
  module.def("identify_scene", &identified);
}

}  // namespace python
