// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "backlash/identification/scene_identification.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "identify_scene_output.hpp"
#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct SceneArguments {
  CommonOptions common;
  std::vector<std::string> data;
  std::string force, output;
  std::string component = "both";
  std::string weight = "relative";
  std::vector<std::string> fix, bound, where;
  bool compare = false;
};

// NAME=TEXT; m1 and m2 stand for mass1 and mass2.
std::pair<std::string, std::string> assignment(const char* option, const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw std::invalid_argument(std::string(option) + " " + io::quoted(text) +
                                ": expected NAME=" + (option == std::string("--fix") ? "VALUE" : "LOW:HIGH"));
  std::string name = text.substr(0, equals);
  if (name == "m1") name = "mass1";
  if (name == "m2") name = "mass2";
  return {name, text.substr(equals + 1)};
}

std::vector<frac::ParameterConstraint> constraints_of(const SceneArguments& given) {
  std::vector<frac::ParameterConstraint> constraints;
  for (const auto& text : given.fix) {
    const auto [name, value] = assignment("--fix", text);
    constraints.push_back({name, number_option("--fix " + name, value), {}, {}, {}});
  }
  for (const auto& text : given.bound) {
    const auto [name, range] = assignment("--bound", text);
    const auto [lower, upper] = range_option("--bound", range);
    frac::ParameterConstraint constraint{name, {}, {}, {}, {}};
    if (!lower.empty()) constraint.lower = number_option("--bound " + name, lower);
    if (!upper.empty()) constraint.upper = number_option("--bound " + name, upper);
    constraints.push_back(constraint);
  }
  return constraints;
}

// One curve of the data: a file, or the rows of a scene in it.
struct CurveSource {
  std::string file;
  io::Metadata rows;
};

std::vector<CurveSource> curve_sources(const SceneArguments& given, const std::vector<io::PointFilter>& where) {
  std::vector<CurveSource> sources;
  for (const auto& file : given.data) {
    const auto scenes = io::scenes_in(file, where);
    if (scenes.empty()) sources.push_back({file, {}});
    for (const auto& scene : scenes) {
      for (const auto& [column, value] : scene)
        if (column != "force_n")
          throw std::invalid_argument(file + " holds curves of different pairs of masses, told apart by column " +
                                      column + "; take one pair by --where '" + column + "==" + value + "'");
      sources.push_back({file, scene});
    }
    if (!scenes.empty() && !given.force.empty())
      throw std::invalid_argument("--force has no meaning with " + file + ", whose column force_n tells the forces");
  }
  return sources;
}

double force_of(const std::vector<double>& listed, std::size_t i, const std::string& name,
                const io::FrequencyResponseFile& file) {
  if (!listed.empty()) return listed.size() == 1 ? listed.front() : listed[i];
  const auto header = io::find_value(file.metadata, "force_n");
  if (!header)
    throw std::invalid_argument(name + " has no line '# force_n: VALUE'; give the force amplitudes by --force");
  const auto value = io::parse_number(*header);
  if (!value || !(*value > 0) || *value == std::numeric_limits<double>::infinity())
    throw io::DataError(name, 0, 0, "has force_n " + io::quoted(*header) + "; expected a positive number of newtons");
  return *value;
}

int run_identify_scene(const SceneArguments& given) {
  const io::OutputFile out(given.common.out, given.data);
  backlash::SceneIdentificationOptions options;
  options.component = frac::component_from_string(given.component);
  options.weight = frac::weight_from_string(given.weight);
  options.constraints = constraints_of(given);
  options.threads = given.common.threads;
  const std::vector<double> listed =
      given.force.empty() ? std::vector<double>{} : io::parse_list(given.force, "--force");
  if (listed.size() > 1 && listed.size() != given.data.size())
    throw std::invalid_argument("--force names " + std::to_string(listed.size()) + " amplitudes for " +
                                std::to_string(given.data.size()) + " files; expected one for all or one per file");
  io::FrequencyResponseReadOptions reading;
  for (const auto& text : given.where) reading.where.emplace_back(text);

  std::vector<backlash::MeasuredDescribingFunction> curves;
  std::string output = given.output;
  SceneRun run{"", {}, {}, {}};
  const auto sources = curve_sources(given, reading.where);
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const auto& name = sources[i].file;
    reading.rows = sources[i].rows;
    auto file = io::read_frequency_response(name, reading);
    for (const auto& note : file.notes) say(given.common, name + ": " + note);
    if (options.weight == frac::Weight::given && file.data.sigma().empty())
      throw io::DataError(name, 0, 0, "has no column sigma or weight; expected one with --weight given");
    const std::string measured{io::find_value(file.metadata, "output").value_or(std::string_view{})};
    if (!measured.empty() && output.empty()) output = measured;
    if (!measured.empty() && measured != output)
      throw std::invalid_argument(name + " is of " + measured + ", not of " + output +
                                  "; all files must be of the same mass");
    run.files.push_back(name);
    run.forces.push_back(force_of(listed, i, name, file));
    curves.push_back({std::move(file.data), run.forces.back()});
  }
  options.output = backlash::output_from_string(output.empty() ? "x1" : output);
  const auto result = backlash::identify_scene(curves, options);
  std::optional<backlash::SceneComparison> comparison;
  const bool usable = result.termination != frac::FitTermination::no_usable_start;
  if (given.compare && usable) comparison = backlash::compare_explanations(curves, options, result);

  CommandLine command("identify-scene");
  for (const auto& file : given.data) command.argument(file);
  std::string forces;
  for (const double force : run.forces) forces += (forces.empty() ? "" : ",") + io::format_number(force);
  if (sources.size() == given.data.size()) command.option("--force", forces);
  command.option("--output", std::string(backlash::to_string(options.output)))
      .option("--component", given.component)
      .option("--weight", given.weight);
  for (const auto& text : given.fix) command.option("--fix", text);
  for (const auto& text : given.bound) command.option("--bound", text);
  for (const auto& text : given.where) command.option("--where", text);
  run.command = command.text() + (given.compare ? " --compare" : "");
  run.options = {{"output", std::string(backlash::to_string(options.output))},
                 {"component", given.component},
                 {"weight", given.weight}};
  out.write(chosen_format(given.common, "json") == "json" ? scene_json(run, result, comparison)
                                                          : scene_table(run, result, comparison));
  const bool found = result.termination == frac::FitTermination::converged &&
                     std::any_of(result.parameters.begin(), result.parameters.end(),
                                 [](const auto& parameter) { return parameter.identified; });
  if (!found) say(given.common, "no usable result: " + result.message);
  return found ? usable_result : no_usable_result;
}

}  // namespace

void add_identify_scene(CLI::App& program, Run& run) {
  const auto given = std::make_shared<SceneArguments>();
  auto* scene = program.add_subcommand(
      "identify-scene", "Estimates clearance, restitution and masses from describing functions of two masses");
  scene
      ->add_option("DATA", given->data,
                   "Frequency responses in m/N, one per force amplitude: CSV or TSV as for `fit`, or tables of several "
                   "forces as simulate writes them")
      ->required()
      ->type_name("FILE");
  scene
      ->add_option("--force", given->force,
                   "Force amplitudes, N: one per file or one for all (default: the files' lines '# force_n: VALUE')")
      ->type_name("LIST");
  scene->add_option("--output", given->output, "Mass measured (default: as the files say, else x1)")
      ->type_name("MASS")
      ->check(one_of(spellings(backlash::outputs())));
  scene->add_option("--component", given->component, "Part fitted")
      ->capture_default_str()
      ->type_name("PART")
      ->check(one_of(spellings(std::array{frac::Component::both, frac::Component::real, frac::Component::imaginary})));
  scene
      ->add_option(
          "--weight", given->weight,
          "Residuals are divided by: relative |data|; given the files' sigma or weight column; absolute nothing")
      ->capture_default_str()
      ->type_name("WEIGHT")
      ->check(one_of(spellings(std::array{frac::Weight::relative, frac::Weight::given, frac::Weight::absolute})));
  add_repeatable(*scene, "--fix", given->fix,
                 "Known value of mass1, mass2, clearance or restitution; repeatable.  x1 needs a mass or the clearance",
                 "NAME=VALUE");
  add_repeatable(*scene, "--bound", given->bound, "Limits of a parameter, one side may be left out; repeatable",
                 "NAME=LOW:HIGH");
  add_repeatable(
      *scene, "--where", given->where,
      "Use only points that satisfy a comparison of re, im, magnitude, omega or f, or of any column of the files, "
      "with a number; repeatable",
      "TEST");
  scene->add_flag("--compare", given->compare,
                  "Also rank static backlash, fractional and integer-order structures on the same points");
  add_common_options(*scene, given->common, {"json", "table"});
  scene->footer(
      "Examples:\n"
      "  fracfit identify-scene f10.csv f30.csv f50.csv --fix mass1=1\n"
      "  fracfit identify-scene a.csv b.csv --force 10,50 --output x2 --component imaginary --fix mass1=1\n"
      "  fracfit identify-scene f*.csv --fix mass1=1 --fix mass2=1 --compare --format table");
  scene->callback([given, &run] { run = [given] { return run_identify_scene(*given); }; });
}

}  // namespace fracfit
