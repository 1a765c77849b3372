// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>

#include "backlash/orbit_continuation.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/progress_bar.hpp"
#include "orbits_output.hpp"
#include "scene_options.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct OrbitsOptions {
  CommonOptions common;
  SceneOptions scene;
  std::string parameter = "omega", from, to;
  std::string omega, restitution;
  std::string output = "x1", longest_period = "4", most_impacts = "16";
};

int small_count(std::string_view name, const std::string& text, std::size_t lowest) {
  constexpr std::size_t highest = 1000;
  return static_cast<int>(count_option(name, text, lowest, highest));
}

int run_orbits(const OrbitsOptions& given) {
  const auto parameter = backlash::orbit_parameter_from_string(given.parameter);
  const bool over_omega = parameter == backlash::OrbitParameter::omega;
  const bool over_restitution = parameter == backlash::OrbitParameter::restitution;
  if (over_omega != given.omega.empty()) {
    throw std::invalid_argument(over_omega ? "--omega is what changes from --from to --to; leave it out"
                                           : "--omega is missing: the angular frequency (rad/s) that is held");
  }
  if (over_restitution != given.restitution.empty()) {
    throw std::invalid_argument(over_restitution ? "--restitution is what changes from --from to --to; leave it out"
                                                 : "--restitution is missing: expected a number from 0 to 1");
  }
  const io::OutputFile file(given.common.out);
  const backlash::TwoMassSystem system = system_of(given.scene, over_restitution ? "0" : given.restitution);
  const double from = number_option("--from", given.from);
  const double to = number_option("--to", given.to);
  const double omega = over_omega ? from : number_option("--omega", given.omega);
  backlash::OrbitContinuationOptions options;
  options.output = backlash::output_from_string(given.output);
  options.longest_period = small_count("--longest-period", given.longest_period, 1);
  options.most_impacts = small_count("--most-impacts", given.most_impacts, 2);
  options.threads = given.common.threads;
  frac::Progress progress;
  const auto diagram = [&] {
    const io::ProgressBar bar("orbits", progress, !given.common.quiet);
    return backlash::orbit_diagram(system, number_option("--force", given.scene.force), omega, parameter, from, to,
                                   options, &progress);
  }();
  CommandLine line = scene_command("orbits", given.scene, given.parameter);
  line.option("--parameter", given.parameter).option("--from", given.from).option("--to", given.to);
  if (!over_omega) line.option("--omega", given.omega);
  if (!over_restitution) line.option("--restitution", given.restitution);
  const std::string command = line.option("--output", given.output)
                                  .option("--longest-period", given.longest_period)
                                  .option("--most-impacts", given.most_impacts)
                                  .text();
  file.write(given.common.format == "json" ? orbits_json(diagram, command) : orbits_csv(diagram, command));
  if (diagram.branches.empty()) {
    say(given.common, "no periodic orbit without rests between these values");
    return no_usable_result;
  }
  const auto lost = std::count_if(diagram.branches.begin(), diagram.branches.end(), [](const auto& branch) {
    const auto failed = [](backlash::BranchEnd end) {
      return end == backlash::BranchEnd::lost || end == backlash::BranchEnd::too_long;
    };
    return failed(branch.begin) || failed(branch.end);
  });
  if (lost > 0) say(given.common, std::to_string(lost) + " branches could not be followed to their end");
  return usable_result;
}

}  // namespace

void add_orbits(CLI::App& program, Run& run) {
  const auto given = std::make_shared<OrbitsOptions>();
  auto* orbits = program.add_subcommand("orbits",
                                        "Branches of periodic orbits over frequency, force, clearance or restitution, "
                                        "stable and unstable, with their bifurcations");
  orbits->add_option("--parameter", given->parameter, "What changes")
      ->capture_default_str()
      ->type_name("NAME")
      ->check(one_of(spellings(backlash::orbit_parameters())));
  orbits->add_option("--from", given->from, "Its lowest value (rad/s, N, m or 1)")->required()->type_name("VALUE");
  orbits->add_option("--to", given->to, "Its highest value")->required()->type_name("VALUE");
  orbits->add_option("--restitution", given->restitution, "Coefficient of restitution, 0 to 1, unless it changes")
      ->type_name("EPS");
  orbits->add_option("--omega", given->omega, "Angular frequency, rad/s, unless it changes")->type_name("W");
  add_scene_options(*orbits, given->scene);
  orbits->add_option("--output", given->output, "Position read")
      ->capture_default_str()
      ->type_name("MASS")
      ->check(one_of(spellings(backlash::outputs())));
  orbits->add_option("--longest-period", given->longest_period, "Force periods of the longest orbits kept")
      ->capture_default_str()
      ->type_name("N");
  orbits->add_option("--most-impacts", given->most_impacts, "Impacts of the longest orbits kept")
      ->capture_default_str()
      ->type_name("N");
  add_common_options(*orbits, given->common, {"csv", "json"});
  orbits->footer(
      "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
      "Not every orbit is promised: one that attracts few starts and does not hang together with the others by\n"
      "bifurcations may be missed; fracfit basins shows what the starts of one scene settle on.\n"
      "Orbits in which the masses rest in contact are not followed: a branch ends at the grazing before; simulate and\n"
      "map give them (regime chatter), each the only one that its stick leaves.\n"
      "Examples:\n"
      "  fracfit orbits --restitution 0.6 --from 1.3 --to 2.5\n"
      "  fracfit orbits --parameter restitution --omega 1.6 --from 0.1 --to 0.95\n"
      "  fracfit orbits --restitution 0.6 --force 40 --clearance 0.3 --from 14 --to 25 --format json --out "
      "orbits.json");
  orbits->callback([given, orbits, &run] {
    const std::string changing = "--" + given->parameter;
    if ((changing == "--force" || changing == "--clearance") && orbits->count(changing) > 0) {
      throw std::invalid_argument(changing + " is what changes from --from to --to; leave it out");
    }
    run = [given] { return run_orbits(*given); };
  });
}

}  // namespace fracfit
