// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/identification/derived.hpp"
#include "frac/identification/describe.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

using Covariates = std::vector<std::pair<std::string, double>>;

std::vector<frac::JointCurve> curves_of(const py::list& data, const std::vector<std::string>& names,
                                        const std::vector<Covariates>& covariates) {
  std::vector<frac::JointCurve> curves;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto each = data[i].cast<py::dict>();
    if (each.contains("omega"))
      curves.push_back({names[i], spectrum_of(each), covariates[i]});
    else
      curves.push_back({names[i], record_of(each), covariates[i]});
  }
  return curves;
}

// A quantity of the parameters of a curve, those of the laws and what is known of the curve beside.
frac::DerivedEstimate derived(const std::string& definition, const frac::JointFitResult& result,
                              const frac::JointCurveResult& curve, const Covariates& covariates) {
  auto known = curve.parameters;
  const std::size_t of_laws = curve.covariance_with_laws.size() - known.size();
  known.insert(known.end(), result.shared.end() - static_cast<std::ptrdiff_t>(of_laws), result.shared.end());
  std::vector<std::string> names;
  std::vector<double> values;
  for (const auto& each : known) {
    names.push_back(each.name);
    values.push_back(each.value);
  }
  auto covariance = curve.covariance_with_laws;
  for (const auto& [name, value] : covariates) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    names.push_back(name);
    values.push_back(value);
  }
  // What is known beside has no error.
  for (auto& row : covariance) row.resize(names.size(), 0.0);
  covariance.resize(names.size(), std::vector<double>(names.size(), 0.0));
  return frac::DerivedQuantity(definition, names).at(values, covariance, result.half_width);
}

py::dict fitted(const py::list& data, const std::vector<std::string>& names, const std::vector<Covariates>& covariates,
                const std::string& model, const py::dict& given, const std::vector<std::string>& definitions) {
  const frac::NamedModel named = frac::find_model(model);
  if (named.is_family())
    throw std::invalid_argument("model " + model + " is a family, whose parameters differ from curve to curve");
  frac::JointFitOptions options;
  options.fit = fit_options(given);
  options.over_time = time_fit_options(given);
  options.fit.constraints = constraints_of(named, given);
  options.shared = given["shared"].cast<std::vector<std::string>>();
  options.laws = given["law"].cast<std::vector<std::string>>();
  if (!given["shift"].is_none())
    options.shift =
        frac::CurveShift{given["reference"].cast<std::size_t>(), given["shift"].cast<std::string>() == "both"};
  options.threads = given["threads"].cast<int>();
  const auto curves = curves_of(data, names, covariates);
  const frac::Structure structure(named.formula);
  const auto found = result_of([&](frac::Progress&) { return frac::joint_fit(curves, structure, options); });
  py::dict dict = dict_of(found);
  dict["usable"] = found.usable();
  dict["summary"] = found.summary();
  dict["priors"] = object_of(found.priors);
  for (std::size_t c = 0; c < found.curves.size(); ++c) {
    py::dict curve = dict["curves"].cast<py::list>()[c];
    curve["priors"] = object_of(found.curves[c].priors);
    py::list list;
    for (const auto& definition : definitions)
      list.append(dict_of(derived(definition, found, found.curves[c], covariates[c])));
    curve["derived"] = list;
  }
  return dict;
}

}  // namespace

void add_joint_fit(py::module_& module) {
  module.attr("described")["JointFit"] = attributes_of<frac::JointFitResult>();
  module.def("joint_fit", &fitted);
  module.def("formula_of", [](const std::string& model) { return frac::find_model(model).formula; });
}

}  // namespace python
