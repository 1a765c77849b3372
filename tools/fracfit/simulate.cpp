// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "backlash/describing_function.hpp"
#include "backlash/static_backlash.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/progress_bar.hpp"
#include "io/sweep_file.hpp"
#include "json_output.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct SimulateOptions {
  CommonOptions common;
  std::string force, clearance, restitution, omega;
  std::string mass1 = "1", mass2 = "1";
  std::string output, model = "dynamic", protocol, tolerance, shard;
  bool diagnostics = false;
};

CommandLine scene_command(const SimulateOptions& given) {
  CommandLine command("simulate");
  command.option("--force", given.force).option("--clearance", given.clearance);
  if (!given.restitution.empty()) command.option("--restitution", given.restitution);
  command.option("--m1", given.mass1)
      .option("--m2", given.mass2)
      .option("--omega", given.omega)
      .option("--model", given.model);
  return command;
}

int simulate_static(const SimulateOptions& given, const io::OutputFile& file) {
  for (const auto& [name, text] :
       {std::pair{"--protocol", &given.protocol}, std::pair{"--tolerance", &given.tolerance}})
    if (!text->empty())
      throw std::invalid_argument(std::string(name) + " has no meaning with --model static, which is a closed form");
  if (!given.shard.empty())
    throw std::invalid_argument("--shard has no meaning with --model static, which is a closed form of one scene");
  if (given.diagnostics)
    throw std::invalid_argument("--diagnostics has no meaning with --model static, which is a closed form");
  if (!given.output.empty() && backlash::output_from_string(given.output) != backlash::Output::x1)
    throw std::invalid_argument("--output " + given.output +
                                ": the static model gives the mass behind the backlash, x1, alone");
  io::StaticCurve curve{number_option("--m1", given.mass1),
                        number_option("--m2", given.mass2),
                        number_option("--clearance", given.clearance),
                        number_option("--force", given.force),
                        io::parse_grid(given.omega, "--omega"),
                        {}};
  curve.value = backlash::static_describing_function(curve.mass1, curve.mass2, curve.clearance, curve.force_amplitude,
                                                     curve.omega);
  const std::string command = scene_command(given).text();
  file.write(given.common.format == "json" ? static_curve_json(curve, command) : io::static_curve_csv(curve, command));
  return usable_result;
}

// Every combination, force slowest.
std::vector<backlash::SweepScene> scenes_of(const SimulateOptions& given) {
  const auto distinct = [](const std::string& name, const std::string& text) {
    std::vector<double> values = io::parse_grid(text, name);
    // "0,3" may be meant as 0.3; two scenes in place of one would go unnoticed.
    if (values.size() == 2 && text.find(',') != std::string::npos)
      throw std::invalid_argument(name + " " + io::quoted(text) +
                                  ": expected one number with a decimal point, or several as FROM:TO:COUNT or as a "
                                  "list of three or more");
    std::vector<double> sorted = values;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) throw std::invalid_argument(name + " holds " + io::format_number(*twice) + " twice");
    return values;
  };
  const double mass1 = number_option("--m1", given.mass1), mass2 = number_option("--m2", given.mass2);
  const auto clearances = distinct("--clearance", given.clearance);
  const auto restitutions = distinct("--restitution", given.restitution);
  const auto forces = distinct("--force", given.force);
  require_table_size(
      {{"--force", forces.size()}, {"--clearance", clearances.size()}, {"--restitution", restitutions.size()}});
  std::vector<backlash::SweepScene> scenes;
  for (const double force : forces) {
    for (const double clearance : clearances) {
      for (const double restitution : restitutions)
        scenes.push_back({backlash::TwoMassSystem(mass1, mass2, clearance, restitution), force});
    }
  }
  return scenes;
}

std::string text_of(const std::vector<backlash::DescribingFunctionSweep>& sweeps, bool single,
                    const SimulateOptions& given, const std::string& command, const io::Shard& shard) {
  const auto columns = given.diagnostics ? io::PointColumns::with_diagnostics : io::PointColumns::basic;
  if (given.common.format == "json") return single ? sweep_json(sweeps.front(), command) : sweeps_json(sweeps, command);
  return single ? io::sweep_csv(sweeps.front(), command, columns) : io::sweeps_csv(sweeps, command, columns, shard);
}

int simulate_dynamic(const SimulateOptions& given, const io::OutputFile& file) {
  if (given.restitution.empty())
    throw std::invalid_argument("--restitution is required with --model dynamic; expected a number in [0, 1]");
  backlash::SweepOptions options;
  if (!given.output.empty()) options.output = backlash::output_from_string(given.output);
  if (!given.protocol.empty()) options.protocol = backlash::protocol_from_string(given.protocol);
  if (!given.tolerance.empty()) options.tolerance = number_option("--tolerance", given.tolerance);
  options.threads = given.common.threads;
  const std::vector<backlash::SweepScene> all = scenes_of(given);
  const io::Shard shard = shard_option(given.shard);
  if (shard.count > 1 && given.common.format == "json")
    throw std::invalid_argument("--shard is for CSV, which fracfit merge joins; leave --format json out");
  if (shard.index > all.size())
    throw std::invalid_argument("--shard " + given.shard + ": there are only " + std::to_string(all.size()) +
                                " scenes to share");
  const std::vector<backlash::SweepScene> scenes = io::part_of(all, shard);
  const std::vector<double> omega = io::parse_grid(given.omega, "--omega");
  require_table_size({{"scenes", scenes.size()}, {"--omega", omega.size()}});

  frac::Progress progress;
  const auto sweeps = [&] {
    const io::ProgressBar bar("simulate", progress, !given.common.quiet);
    return backlash::describing_function_sweeps(scenes, omega, options, &progress);
  }();
  CommandLine command = scene_command(given);
  command.option("--output", std::string(backlash::to_string(options.output)))
      .option("--protocol", std::string(backlash::to_string(options.protocol)))
      .option("--tolerance", io::format_number(options.tolerance));
  if (given.diagnostics) command.flag("--diagnostics");
  file.write(text_of(sweeps, all.size() == 1, given, command.text(), shard));
  const bool usable = std::all_of(sweeps.begin(), sweeps.end(), [](const auto& sweep) {
    return std::all_of(sweep.points.begin(), sweep.points.end(), [](const auto& point) {
      return std::isfinite(point.value.real()) && std::isfinite(point.value.imag());
    });
  });
  if (!usable) say(given.common, "some points have no finite value, see the output");
  return usable ? usable_result : no_usable_result;
}

int simulate(const SimulateOptions& given) {
  const io::OutputFile file(given.common.out);
  return given.model == "static" ? simulate_static(given, file) : simulate_dynamic(given, file);
}

}  // namespace

void add_simulate(CLI::App& program, Run& run) {
  const auto given = std::make_shared<SimulateOptions>();
  auto* simulation =
      program.add_subcommand("simulate", "Describing function N(F, w) of two masses with backlash on a frequency grid");
  simulation->add_option("--force", given->force, "Force amplitude on mass 2, N, > 0; several: FROM:TO:COUNT or a list")
      ->required()
      ->type_name("F");
  simulation->add_option("--clearance", given->clearance, "Clearance, m, >= 0; several too")
      ->required()
      ->type_name("DELTA");
  simulation->add_option("--restitution", given->restitution, "Coefficient of restitution, 0 to 1; several too")
      ->type_name("EPS");
  simulation->add_option("--m1", given->mass1, "Mass 1, kg")->capture_default_str()->type_name("M1");
  simulation->add_option("--m2", given->mass2, "Mass 2, kg")->capture_default_str()->type_name("M2");
  simulation
      ->add_option("--omega", given->omega, "Angular frequencies, rad/s: FROM:TO:COUNT, FROM:TO:COUNTlog or a list")
      ->required()
      ->type_name("GRID");
  simulation->add_option("--output", given->output, "Position read (default x1)")
      ->type_name("MASS")
      ->check(one_of(spellings(backlash::outputs())));
  simulation->add_option("--model", given->model, "Motion with impacts, or the closed form without inertia")
      ->capture_default_str()
      ->check(one_of({"dynamic", "static"}))
      ->type_name("MODEL");
  simulation->add_option("--protocol", given->protocol, "Where the motion starts (default sweep-up)")
      ->type_name("P")
      ->check(one_of(spellings(backlash::protocols())));
  simulation
      ->add_option("--tolerance", given->tolerance, "Closure of an orbit, relative to the clearance (default 1e-10)")
      ->type_name("T");
  simulation->add_flag(
      "--diagnostics", given->diagnostics,
      "More columns: even-harmonic ratio, energy defect, Lyapunov exponent, periods followed, whether a mean "
      "may be of a transient, sensitivity to the force where double precision loses the orbit");
  simulation
      ->add_option("--shard", given->shard,
                   "Work on every n-th of several scenes only, from the i-th; join with fracfit merge")
      ->type_name("i/n");
  add_common_options(*simulation, given->common, {"csv", "json"});
  simulation->footer(
      "Several forces, clearances or restitutions give every combination in one table, with columns force_n, "
      "clearance_m, restitution in front.\n"
      "Examples:\n"
      "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 5:35:200log\n"
      "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 0.5:25:200log --output x2 --out "
      "curve.csv\n"
      "  fracfit simulate --force 40 --clearance 0.3 --omega 0.5:25:200log --model static --format json\n"
      "  fracfit simulate --force 10:50:5 --clearance 0.1:0.3:2 --restitution 0.6 --omega 5:35:200log --shard 1/2 "
      "--out "
      "part1.csv");
  simulation->callback([given, &run] { run = [given] { return simulate(*given); }; });
}

}  // namespace fracfit
