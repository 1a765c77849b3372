// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "backlash/static_backlash.hpp"
#include "exit_code.hpp"
#include "fit_output.hpp"
#include "fit_request.hpp"
#include "frac/identification/model_choice.hpp"
#include "frac/parallel_for.hpp"
#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "json_output.hpp"
#include "model_choice.hpp"
#include "subcommand.hpp"
#include "time_request.hpp"

namespace fracfit {
namespace {

struct IdentifyArguments {
  CommonOptions common;
  FitRequest request;
  TimeRequest over_time;
  std::string models;
  std::string force, clearance, mass1, mass2;
  std::string folds;
};

// rms of cross-validation for each candidate; that of a fixed curve, which nothing was fitted to, is its own.
template <class Data, class Options>
std::vector<double> prediction_rms(const Data& data, const Options& options,
                                   const std::vector<frac::NamedModel>& models,
                                   const frac::IdentificationResult& result, std::size_t folds,
                                   const CommonOptions& common) {
  std::vector<double> rms(result.ranking.size(), std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> notes(rms.size());
  frac::parallel_for(rms.size(), common.threads, [&](std::size_t i) {
    const auto& candidate = result.ranking[i];
    if (candidate.model_class == frac::ModelClass::fixed_curve) {
      rms[i] = candidate.fit.rms;
      return;
    }
    const auto model = std::find_if(models.begin(), models.end(),
                                    [&](const frac::NamedModel& each) { return each.name == candidate.name; });
    auto of_model = options;
    of_model.constraints = model->constraints;
    try {
      rms[i] = frac::cross_validation(data, frac::Structure(model->formula), of_model, folds);
    } catch (const std::invalid_argument& error) {
      notes[i] = "no cross-validation of " + candidate.name + ": " + error.what();
    }
  });
  for (const auto& note : notes)
    if (!note.empty()) say(common, note);
  return rms;
}

// What the static-backlash candidate needs.
struct StaticScene {
  std::string force, clearance, mass1, mass2;
};

// From the options; what they leave open, from the header that `simulate` writes.
std::optional<StaticScene> static_scene(const IdentifyArguments& given, const io::Metadata& header) {
  StaticScene scene{given.force, given.clearance, given.mass1, given.mass2};
  std::string taken;
  const auto complete = [&](std::string& value, const char* key) {
    if (!value.empty()) return;
    if (const auto found = io::find_value(header, key)) {
      value = *found;
      taken += (taken.empty() ? "" : ", ") + std::string(key) + " = " + value;
    }
  };
  complete(scene.force, "force_n");
  complete(scene.clearance, "clearance_m");
  complete(scene.mass1, "mass1_kg");
  complete(scene.mass2, "mass2_kg");
  if (scene.force.empty() && scene.clearance.empty()) {
    if (!given.mass1.empty() || !given.mass2.empty())
      throw std::invalid_argument(
          "--m1 and --m2 have no meaning without --force and --clearance, which add the static-backlash curve");
    return std::nullopt;
  }
  if (scene.force.empty()) throw std::invalid_argument("--clearance needs --force for the static-backlash curve");
  if (scene.clearance.empty()) throw std::invalid_argument("--force needs --clearance for the static-backlash curve");
  if (scene.mass1.empty()) scene.mass1 = "1";
  if (scene.mass2.empty()) scene.mass2 = "1";
  if (!taken.empty())
    say(given.common, given.request.data + ": the static-backlash curve takes from the header " + taken);
  return scene;
}

frac::FixedCurve static_curve(const StaticScene& scene, const std::vector<double>& omega) {
  return {"static-backlash",
          backlash::static_describing_function(number_option("--m1", scene.mass1), number_option("--m2", scene.mass2),
                                               number_option("--clearance", scene.clearance),
                                               number_option("--force", scene.force), omega)};
}

template <class Data, class Options>
int write_ranking(const IdentifyArguments& given, const io::OutputFile& out, const Data& data, const Options& options,
                  const std::vector<frac::NamedModel>& models, const frac::IdentificationResult& result,
                  std::size_t folds, const FitRun& run) {
  const auto predictions =
      folds > 0 ? prediction_rms(data, options, models, result, folds, given.common) : std::vector<double>{};
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? identification_json(run, result, predictions)
            : format == "csv" ? identification_csv(run, result, predictions)
                              : identification_table(run, result, predictions));
  if (result.ranking.at(result.chosen).fit.termination == frac::FitTermination::converged) return usable_result;
  say(given.common, "no usable result: " + result.ranking.at(result.chosen).fit.message);
  return no_usable_result;
}

void check_folds(const IdentifyArguments& given, std::size_t folds, std::size_t points) {
  if (folds > points)
    throw std::invalid_argument("--folds " + given.folds + ": more than the " + std::to_string(points) + " points of " +
                                given.request.data);
}

CommandLine command_start(const IdentifyArguments& given) {
  CommandLine command("identify");
  command.argument(given.request.data);
  if (!given.models.empty()) command.option("--models", given.models);
  return command;
}

int identify_over_time(const IdentifyArguments& given, const io::OutputFile& out) {
  refuse_frequency_options(given.request);
  for (const auto& [name, text] : {std::pair{"--force", &given.force}, std::pair{"--clearance", &given.clearance},
                                   std::pair{"--m1", &given.mass1}, std::pair{"--m2", &given.mass2}})
    if (!text->empty())
      throw std::invalid_argument(std::string(name) +
                                  " has no meaning with samples over time: static backlash is a candidate for "
                                  "describing functions, which tell one harmonic at each frequency");
  const auto models = chosen_models(given.models);
  const auto options = time_fit_options(given.request, given.over_time, {});
  const std::size_t folds = given.folds.empty() ? 0 : count_option("--folds", given.folds, 2);
  const auto record = read_time_record(given.request, given.over_time, given.common);
  check_folds(given, folds, record.data.observed().size());
  auto command = command_start(given);
  append_to(command, given.request, record, options);
  if (folds > 0) command.option("--folds", given.folds);
  const auto result = frac::identify(record.data, models, options, given.common.threads);
  return write_ranking(given, out, record.data, options, models, result, folds,
                       time_fit_run(given.request, record, options, command.text()));
}

int run_identify(const IdentifyArguments& given) {
  const io::OutputFile out(given.common.out, {given.request.data});
  if (io::holds_time_response(given.request.data)) return identify_over_time(given, out);
  refuse_time_options(given.over_time);
  const auto options = fit_options(given.request);
  const auto models = chosen_models(given.models);
  const std::size_t folds = given.folds.empty() ? 0 : count_option("--folds", given.folds, 2);
  const auto file = read_data(given.request, given.common);
  check_folds(given, folds, file.data.size());
  const auto scene = static_scene(given, file.metadata);
  std::vector<frac::FixedCurve> curves;
  auto command = command_start(given);
  append_to(command, given.request, options);
  if (scene) {
    curves.push_back(static_curve(*scene, file.data.omega()));
    if (io::find_value(file.metadata, "output") == "x2")
      say(given.common, given.request.data + ": the data are of x2, while the static-backlash curve describes x1");
    command.option("--clearance", scene->clearance).option("--force", scene->force);
    command.option("--m1", scene->mass1).option("--m2", scene->mass2);
  }
  if (folds > 0) command.option("--folds", given.folds);
  const auto result = frac::identify(file.data, models, curves, options, given.common.threads);
  return write_ranking(given, out, file.data, options, models, result, folds,
                       fit_run(given.request, options, file, command.text()));
}

}  // namespace

void add_identify(CLI::App& program, Run& run) {
  const auto given = std::make_shared<IdentifyArguments>();
  auto* identification = program.add_subcommand(
      "identify",
      "Ranks fractional, integer-order and static-backlash structures on a frequency response, or the first two on "
      "samples of input and output over time");
  add_fit_options(*identification, given->request);
  identification
      ->add_option("--models", given->models, "Presets or formulas separated by commas (default: all presets)")
      ->type_name("LIST");
  identification->add_option("--clearance", given->clearance, "Clearance of the static-backlash candidate, m")
      ->type_name("DELTA");
  identification->add_option("--force", given->force, "Its force amplitude, N")->type_name("F");
  identification->add_option("--m1", given->mass1, "Its mass 1, kg (default 1)")->type_name("M1");
  identification->add_option("--m2", given->mass2, "Its mass 2, kg (default 1)")->type_name("M2");
  identification
      ->add_option("--folds", given->folds,
                   "Cross-validate each candidate: predict each of K blocks of neighbouring points from the others")
      ->type_name("K");
  add_time_options(*identification, given->over_time);
  add_common_options(*identification, given->common, {"json", "csv", "table"});
  identification->footer(
      "Samples over time take and refuse the same options as in fit, and none of --clearance, --force, --m1 and "
      "--m2.\n"
      "Examples:\n"
      "  fracfit identify curve.csv --where 'omega<4'\n"
      "  fracfit identify step.csv --models 'lag,lag-delay,oscillator,fractional-lag,fractional-lag-delay'\n"
      "  fracfit identify cell.csv --component both --models 'zarc,two-zarc,r-rc,two-rc' --out ranking.json\n"
      "  fracfit identify curve.csv --where 'omega<4' --clearance 0.3 --force 40 --format table");
  identification->callback([given, &run] { run = [given] { return run_identify(*given); }; });
}

}  // namespace fracfit
