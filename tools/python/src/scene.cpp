// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "arrays.hpp"
#include "backlash/identification/bodies_identification.hpp"
#include "backlash/identification/describe.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/structure.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

template <class Identification>
py::dict dict_of_scene(const Identification& found) {
  py::dict dict = dict_of(found);
  dict["points"] = found.points.size();
  dict["curve"] = column_of<std::int64_t>(found.points, [](const auto& point) { return point.curve; });
  dict["omega"] = column_of<double>(found.points, [](const auto& point) { return point.omega; });
  dict["used"] =
      column_of<bool>(found.points, [](const auto& point) { return point.status == backlash::PointStatus::used; });
  dict["response"] = column_of<std::complex<double>>(found.points, [](const auto& point) { return point.model; });
  dict["usable"] = found.usable();
  return dict;
}

py::dict identified(const py::list& curves, const std::vector<double>& forces, const py::dict& given) {
  std::vector<backlash::MeasuredDescribingFunction> measured;
  const auto harmonics = given["harmonic"].cast<std::vector<int>>();
  for (std::size_t i = 0; i < forces.size(); ++i)
    measured.push_back({spectrum_of(curves[i].cast<py::dict>()), forces[i], harmonics.at(i)});
  backlash::SceneIdentificationOptions options;
  options.output = backlash::output_from_string(given["body"].cast<std::string>());
  options.component = frac::component_from_string(given["component"].cast<std::string>());
  options.weight = frac::weight_from_string(given["weight"].cast<std::string>());
  options.sigma_is_measured = given["sigma_is_measured"].cast<bool>();
  options.contact = backlash::contact_model_from_string(given["contact"].cast<std::string>());
  options.friction = backlash::friction_model_from_string(given["friction"].cast<std::string>());
  options.constraints = constraints_of({}, given);
  options.threads = given["threads"].cast<int>();
  const auto load = given["load_receptance"].cast<std::string>(), drive = given["drive_receptance"].cast<std::string>();
  if (load.empty() && drive.empty())
    return dict_of_scene(result_of([&](frac::Progress&) { return backlash::identify_scene(measured, options); }));
  const backlash::BodiesStructure bodies{frac::Structure(load.empty() ? "1/(mass1 s^2)" : load),
                                         frac::Structure(drive.empty() ? "1/(mass2 s^2)" : drive)};
  py::dict dict =
      dict_of_scene(result_of([&](frac::Progress&) { return backlash::identify_bodies(measured, bodies, options); }));
  // Bodies with receptances meet in hard contacts and have no dry friction.
  for (const char* none : {"combinations", "contact", "friction", "free_directions", "rivals"}) dict[none] = py::list();
  dict["contact_verdict"] = std::string(backlash::to_string(backlash::ContactVerdict::hard));
  dict["friction_verdict"] = std::string(backlash::to_string(backlash::FrictionVerdict::none));
  for (const char* none : {"contact_evidence", "friction_evidence"}) dict[none] = 0.0;
  return dict;
}

}  // namespace

void add_scene(py::module_& module) {
  module.attr("described")["SceneIdentification"] = attributes_of<backlash::SceneIdentification>();
  module.def("identify_scene", &identified);
}

}  // namespace python
