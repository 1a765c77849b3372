// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <string>

#include "arrays.hpp"
#include "fit_request.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of(const frac::RankedFit& candidate) {
  py::dict dict;
  dict["name"] = candidate.name;
  dict["model_class"] = std::string(frac::to_string(candidate.model_class));
  dict["fit"] = python::dict_of(candidate.fit);
  dict["delta_aicc"] = candidate.delta_aicc;
  dict["akaike_weight"] = candidate.akaike_weight;
  dict["adequate"] = candidate.lack_of_fit.adequate;
  dict["misfit"] = candidate.lack_of_fit.misfit;
  dict["from_family"] = candidate.from_family;
  dict["also"] = candidate.also;
  dict["constraints"] = list_of(candidate.model.constraints);
  return dict;
}

py::dict dict_of(const frac::IdentificationResult& result) {
  py::list ranking;
  for (const auto& candidate : result.ranking) ranking.append(dict_of(candidate));
  py::dict dict;
  dict["ranking"] = ranking;
  dict["skipped"] = result.skipped;
  dict["chosen"] = result.chosen;
  dict["verdict"] = std::string(frac::to_string(result.verdict));
  dict["verdict_sentence"] = result.verdict_sentence;
  dict["evidence"] = result.evidence;
  dict["log10_odds"] = result.log10_odds;
  dict["model_error"] = result.model_error;
  dict["usable"] = result.usable();
  dict["summary"] = result.summary();
  dict["next_measurement"] = py::none();
  if (result.next)
    dict["next_measurement"] = py::make_tuple(result.next->lower, result.next->upper, result.next->points);
  return dict;
}

std::vector<frac::NamedModel> models_of(const std::vector<std::string>& names) {
  std::vector<frac::NamedModel> models;
  for (const auto& name : names) models.push_back(frac::find_model(name));
  return models;
}

py::dict identify(const py::dict& data, const std::vector<std::string>& names, const py::dict& curves,
                  const py::dict& given, int threads) {
  if (data.contains("omega")) {
    const auto models = names.empty() ? frac::default_candidates() : models_of(names);
    const frac::FitOptions options = fit_options(given);
    const frac::FrequencyResponseData points = spectrum_of(data);
    std::vector<frac::FixedCurve> fixed;
    for (const auto& [name, value] : curves)
      fixed.push_back({name.cast<std::string>(), vector_of(value.cast<Complexes>())});
    return dict_of(result_of([&](frac::Progress&) { return frac::identify(points, models, fixed, options, threads); }));
  }
  const auto models = names.empty() ? frac::default_candidates_over_time() : models_of(names);
  const frac::TimeFitOptions options = time_fit_options(given);
  const frac::TimeResponseData record = record_of(data);
  return dict_of(result_of([&](frac::Progress&) { return frac::identify(record, models, options, threads); }));
}

}  // namespace

void add_identify(py::module_& module) {
  module.def("identify", &identify);
}

}  // namespace python
