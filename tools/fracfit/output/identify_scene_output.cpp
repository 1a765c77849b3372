// SPDX-License-Identifier: BSD-3-Clause
#include "output/identify_scene_output.hpp"

#include <cmath>

#include "backlash/identification/describe.hpp"
#include "output/aligned_table.hpp"
#include "output/described.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

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

template <typename Identification>
Json identification_json(const SceneRun& run, const Identification& result) {
  Json json = origin(run.command);
  json["data"] = Json::list_of(run.files.size(), [&](std::size_t i) {
    return Json{{"file", run.files[i]}, {"force_n", run.forces[i]}, {"harmonic", run.harmonics[i]}};
  });
  json["options"] = Json::object();
  for (const auto& [key, value] : run.options) json["options"][key] = value;
  json.update(json_of(result));
  return json;
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
    const int harmonic = run.harmonics[curve];
    data.add({run.files[curve] + (harmonic > 1 ? ", harmonic " + std::to_string(harmonic) : ""),
              short_number(run.forces[curve]), std::to_string(all), std::to_string(used), std::to_string(off_branch),
              std::to_string(all - used - off_branch)});
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
  Json json = identification_json(run, result);
  if (comparison) json["comparison"] = json_of(*comparison);
  return json.dump() + "\n";
}

std::string scene_table(const SceneRun& run, const backlash::SceneIdentification& result,
                        const std::optional<backlash::SceneComparison>& comparison) {
  std::string text = data_table(run, result) + "\n" + estimate_table("parameter", result.parameters) + "\n" +
                     estimate_table("combination", result.combinations) + "\n";
  if (!result.contact.empty()) text += estimate_table("contact", result.contact) + "\n";
  if (!result.friction.empty()) text += estimate_table("friction", result.friction) + "\n";
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
  return identification_json(run, result).dump() + "\n";
}

std::string bodies_table(const SceneRun& run, const backlash::BodiesIdentification& result) {
  return data_table(run, result) + "\n" + estimate_table("parameter", result.parameters) + "\n" + verdict_text(result);
}

}  // namespace fracfit
