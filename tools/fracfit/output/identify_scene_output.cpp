// SPDX-License-Identifier: BSD-3-Clause
#include "output/identify_scene_output.hpp"

#include <cmath>

#include "output/aligned_table.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

Json estimate_json(const backlash::SceneEstimate& estimate) {
  return {{"name", estimate.name},
          {"unit", estimate.unit},
          {"value", estimate.value},
          {"standard_error", estimate.standard_error},
          {"ci95", {estimate.ci95_lower, estimate.ci95_upper}},
          {"identified", estimate.identified},
          {"at_bound", estimate.at_bound},
          {"fixed", estimate.fixed}};
}

template <typename Estimates>
std::string estimate_table(const std::string& heading, const Estimates& estimates) {
  AlignedTable table({heading, "unit", "value", "standard error", "95 % interval", ""}, AlignedTable::Last::remark);
  for (const auto& estimate : estimates) {
    const auto [value, standard_error, interval] =
        estimate_cells(estimate, std::isfinite(estimate.standard_error) && !estimate.fixed);
    table.add({estimate.name, estimate.unit, value, standard_error, interval, parameter_state(estimate)});
  }
  return table.text();
}

// What identifications of every kind tell alike, before and after what is their own.
template <typename Identification>
Json common_json(const SceneRun& run, const Identification& result) {
  Json json = origin(run.command);
  json["data"] = Json::list_of(run.files.size(), [&](std::size_t i) {
    return Json{{"file", run.files[i]}, {"force_n", run.forces[i]}};
  });
  json["options"] = Json::object();
  for (const auto& [key, value] : run.options) json["options"][key] = value;
  json["parameters"] = Json::list(result.parameters, estimate_json);
  return json;
}

template <typename Identification>
void add_common_json(Json& json, const Identification& result) {
  json["cost"] = result.cost;
  json["rms"] = result.rms;
  json["max_residual"] = result.max_residual;
  json["termination"] = frac::to_string(result.termination);
  json["message"] = result.message;
  json["residuals"] = result.residuals;
  json["free_parameters"] = result.free_parameters;
  json["condition"] = result.condition;
  json["starts"] = result.starts;
  json["starts_at_best"] = result.starts_at_best;
  json["seconds"] = result.seconds;
  json["points_used"] = result.points_used;
  json["points"] = Json::list(result.points, [](const auto& point) {
    return Json{{"curve", point.curve},
                {"omega_rad_s", point.omega},
                {"status", backlash::to_string(point.status)},
                {"regime", backlash::to_string(point.regime)},
                {"model_re_m_per_n", point.model.real()},
                {"model_im_m_per_n", point.model.imag()},
                {"residual_re", point.residual.real()},
                {"residual_im", point.residual.imag()}};
  });
}

template <typename Identification>
std::string data_table(const SceneRun& run, const Identification& result) {
  AlignedTable data({"data", "force/N", "points", "used", "off branch", "irregular"});
  for (std::size_t curve = 0; curve < run.files.size(); ++curve) {
    std::size_t all = 0, used = 0, off_branch = 0;
    for (const auto& point : result.points) {
      if (point.curve != curve) continue;
      ++all;
      used += point.status == backlash::PointStatus::used ? 1 : 0;
      off_branch += point.status == backlash::PointStatus::off_branch ? 1 : 0;
    }
    data.add({run.files[curve], short_number(run.forces[curve]), std::to_string(all), std::to_string(used),
              std::to_string(off_branch), std::to_string(all - used - off_branch)});
  }
  return data.text();
}

template <typename Identification>
std::string verdict_text(const Identification& result) {
  return paragraph(std::string(frac::to_string(result.termination)) + ": " + result.message + " " +
                   short_number(result.seconds) + " s.");
}

}  // namespace

std::string scene_json(const SceneRun& run, const backlash::SceneIdentification& result,
                       const std::optional<backlash::SceneComparison>& comparison) {
  Json json = common_json(run, result);
  json["combinations"] = Json::list(result.combinations, estimate_json);
  json["free_directions"] = result.free_directions;
  json["misfits"] = result.misfits;
  json["residual_correlation"] = result.residual_correlation;
  json["rivals"] = Json::list(result.rivals, [](const auto& rival) {
    const auto& [mass1, mass2, clearance, restitution] = rival.parameters;
    return Json{{"mass1", mass1},
                {"mass2", mass2},
                {"clearance", clearance},
                {"restitution", restitution},
                {"odds_against", rival.odds}};
  });
  add_common_json(json, result);
  if (comparison) {
    Json ranking = Json::list(comparison->ranking, [](const auto& fit) {
      return Json{{"explanation", backlash::to_string(fit.explanation)},
                  {"name", fit.name},
                  {"cost", fit.cost},
                  {"rms", fit.rms},
                  {"free_parameters", fit.free_parameters},
                  {"aicc", fit.aicc},
                  {"delta_aicc", fit.delta_aicc}};
    });
    json["comparison"] = {{"ranking", std::move(ranking)},
                          {"points", comparison->points},
                          {"residuals", comparison->residuals},
                          {"skipped", comparison->skipped},
                          {"sentence", comparison->sentence}};
  }
  return json.dump() + "\n";
}

std::string scene_table(const SceneRun& run, const backlash::SceneIdentification& result,
                        const std::optional<backlash::SceneComparison>& comparison) {
  std::string text = data_table(run, result) + "\n" + estimate_table("parameter", result.parameters) + "\n" +
                     estimate_table("combination", result.combinations) + "\n";
  for (const auto& direction : result.free_directions) text += direction + "\n";
  text += verdict_text(result);
  if (comparison) {
    AlignedTable ranking({"explanation", "model", "free", "rms", "AICc above best"});
    for (const auto& fit : comparison->ranking)
      ranking.add({std::string(backlash::to_string(fit.explanation)), fit.name, std::to_string(fit.free_parameters),
                   short_number(fit.rms), short_number(fit.delta_aicc)});
    text += "\n" + ranking.text() + paragraph(comparison->sentence);
  }
  return text;
}

std::string bodies_json(const SceneRun& run, const backlash::BodiesIdentification& result) {
  Json json = common_json(run, result);
  json["misfits"] = result.misfits;
  json["residual_correlation"] = result.residual_correlation;
  add_common_json(json, result);
  return json.dump() + "\n";
}

std::string bodies_table(const SceneRun& run, const backlash::BodiesIdentification& result) {
  return data_table(run, result) + "\n" + estimate_table("parameter", result.parameters) + "\n" + verdict_text(result);
}

}  // namespace fracfit
