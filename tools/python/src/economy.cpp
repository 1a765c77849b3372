// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/economy.hpp"

#include <string>
#include <vector>

#include "arrays.hpp"
#include "fit_request.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of(const frac::EconomyPoint& point) {
  py::dict dict;
  dict["parameters"] = point.parameters;
  dict["error"] = point.error;
  dict["proven"] = point.proven;
  dict["fractional"] = point.fractional;
  dict["model"] = point.model;
  return dict;
}

py::dict dict_of(const frac::EconomyCurve& curve) {
  py::list needs, points;
  for (const double error : frac::economy_errors()) {
    const frac::EconomyPoint* const point = curve.within(error);
    needs.append(point ? py::object(py::int_(point->parameters)) : py::none());
  }
  for (const auto& point : curve.points) points.append(dict_of(point));
  py::dict dict;
  dict["name"] = curve.name;
  dict["class"] = std::string(to_string(curve.model_class));
  dict["description"] = std::string(description(curve.model_class));
  dict["needs"] = needs;
  dict["points"] = points;
  return dict;
}

// Named as in the JSON of the command line.
py::dict economy(const py::dict& data, const py::dict& curves, const std::string& component, std::size_t most,
                 int largest_power, int threads) {
  const frac::FrequencyResponseData points = spectrum_of(data);
  const std::vector<frac::FixedCurve> given = fixed_curves(curves, points.size());
  const frac::EconomyOptions options{frac::component_from_string(component), most, largest_power};
  const frac::Economy found =
      result_of([&](frac::Progress&) { return frac::economy(points, given, options, threads); });
  py::list each;
  for (const auto& curve : found.curves) each.append(dict_of(curve));
  const auto errors = frac::economy_errors();
  py::dict dict;
  dict["component"] = std::string(frac::to_string(found.component));
  dict["most_parameters"] = found.most_parameters;
  dict["rounding"] = found.rounding;
  dict["errors"] = std::vector<double>(errors.begin(), errors.end());
  dict["verdict"] = std::string(to_string(found.verdict));
  dict["sentence"] = found.sentence;
  dict["curves"] = each;
  return dict;
}

}  // namespace

void add_economy(py::module_& module) {
  module.def("economy", &economy);
}

}  // namespace python
