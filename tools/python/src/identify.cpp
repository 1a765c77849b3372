// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <algorithm>
#include <complex>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "described.hpp"
#include "fit_request.hpp"
#include "frac/identification/cross_validation.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/economy.hpp"
#include "frac/identification/screened_fit.hpp"
#include "frac/structure.hpp"
#include "parts.hpp"
#include "run.hpp"

namespace python {
namespace {

py::dict dict_of_candidate(const frac::RankedFit& candidate) {
  py::dict dict = dict_of(candidate);
  dict["fit"] = dict_of_fit(candidate.fit);
  dict["adequate"] = candidate.lack_of_fit.adequate;
  dict["misfit"] = candidate.lack_of_fit.misfit;
  dict["constraints"] = list_of(candidate.model.constraints);
  return dict;
}

py::dict dict_of_ranking(const frac::IdentificationResult& result) {
  py::dict dict = dict_of(result);
  py::list ranking;
  for (const auto& candidate : result.ranking) ranking.append(dict_of_candidate(candidate));
  dict["ranking"] = ranking;
  dict["chosen"] = result.chosen;
  dict["advice"] = list_of(result.advice);
  dict["usable"] = result.usable();
  dict["summary"] = result.summary();
  for (const char* each : {"next_measurement", "next_accuracy", "next_evidence"}) dict[each] = py::none();
  if (result.next) {
    dict["next_measurement"] = py::make_tuple(result.next->lower, result.next->upper, result.next->points);
    dict["next_accuracy"] = result.next->accuracy;
    dict["next_evidence"] = result.next->expected_evidence;
  }
  dict["distribution"] = result.distribution ? py::object(dict_of(*result.distribution)) : py::none();
  return dict;
}

std::vector<frac::NamedModel> models_of(const std::vector<std::string>& names) {
  std::vector<frac::NamedModel> models;
  for (const auto& name : names) models.push_back(frac::find_model(name));
  return models;
}

// With the limits "bounds", each model with those of its own parameters.
std::vector<frac::NamedModel> bounded(std::vector<frac::NamedModel> models, const py::dict& given) {
  for (const auto& [key, range] : given["bounds"].cast<py::dict>()) {
    const auto name = key.cast<std::string>();
    py::dict limits, request;
    limits[key] = range;
    for (const char* each : {"fixed", "start", "prior"}) request[each] = py::dict();
    request["constraint"] = py::list();
    request["bounds"] = limits;
    bool known = false;
    for (auto& model : models) {
      if (model.is_family()) continue;
      const frac::Structure structure(model.formula);
      const auto& names = structure.parameter_names();
      if (std::find(names.begin(), names.end(), name) == names.end()) continue;
      known = true;
      model.constraints = constraints_of(model, request);
    }
    if (!known)
      throw std::invalid_argument("bounds of " + name +
                                  ": no candidate that is a preset or a formula has such a parameter");
  }
  return models;
}

void add_predictions(py::dict& dict, const frac::CandidatePredictions& predictions) {
  const py::list ranking = dict["ranking"];
  for (std::size_t i = 0; i < predictions.rms.size(); ++i) ranking[i]["prediction_rms"] = predictions.rms[i];
  for (const auto& note : predictions.notes) dict["said"].cast<py::list>().append(note);
}

std::optional<std::size_t> folds_of(const py::dict& given) {
  return given["folds"].cast<std::optional<std::size_t>>();
}

py::dict identify_spectrum(const py::dict& data, const std::vector<std::string>& names, const py::dict& curves,
                           const py::dict& given, int threads) {
  const auto models = bounded(names.empty() ? frac::default_candidates() : models_of(names), given);
  frac::FitOptions options = fit_options(given);
  const bool keep = keeps_outliers(given);
  const frac::FrequencyResponseData all = spectrum_of(data);
  const auto fixed = fixed_curves(curves, all.size());
  std::vector<std::size_t> left_out;
  std::vector<std::string> notes = settle_component(options, all);
  for (auto& note : note_of_sign(all, options)) notes.push_back(std::move(note));
  const auto folds = folds_of(given);
  frac::CandidatePredictions predictions;
  const auto result = result_of([&](frac::Progress&) {
    frac::ScreenedData points(all, options, keep);
    for (auto& note : notes_of(points)) notes.push_back(std::move(note));
    auto ranking = frac::identify(points, models, fixed, options, threads);
    if (!points.taken_back().empty()) notes.push_back(points.taken_back());
    auto weighed = options;
    if (options.weight == frac::Weight::learned) weighed.noise_floor = ranking.noise_floor;
    if (folds) predictions = frac::cross_validations(points.kept(), weighed, ranking, *folds, threads);
    for (auto& each : ranking.ranking) points.restore_indices(each.fit.outliers);
    left_out = points.left_out();
    return ranking;
  });
  py::dict dict = dict_of_ranking(result);
  dict["left_out"] = left_out;
  dict["said"] = notes;
  dict["component"] = std::string(frac::to_string(options.component));
  dict["without_noise"] = result.without_noise();
  add_predictions(dict, predictions);
  return dict;
}

py::dict identify_record(const py::dict& data, const std::vector<std::string>& names, const py::dict& given,
                         int threads) {
  const auto models = bounded(names.empty() ? frac::default_candidates_over_time() : models_of(names), given);
  const frac::TimeFitOptions options = time_fit_options(given);
  const frac::TimeResponseData record = record_of(data);
  const auto folds = folds_of(given);
  frac::CandidatePredictions predictions;
  py::dict dict = dict_of_ranking(result_of([&](frac::Progress&) {
    auto ranking = frac::identify(record, models, options, threads);
    if (folds) predictions = frac::cross_validations(record, options, ranking, *folds, threads);
    return ranking;
  }));
  dict["left_out"] = py::list();
  dict["said"] = py::list();
  dict["component"] = py::none();
  dict["without_noise"] = false;
  add_predictions(dict, predictions);
  return dict;
}

py::dict identify(const py::dict& data, const std::vector<std::string>& names, const py::dict& curves,
                  const py::dict& given, int threads) {
  return data.contains("omega") ? identify_spectrum(data, names, curves, given, threads)
                                : identify_record(data, names, given, threads);
}

}  // namespace

void add_identify(py::module_& module) {
  module.attr("described")["Identification"] = attributes_of<frac::IdentificationResult>();
  module.def("identify", &identify);
}

}  // namespace python
