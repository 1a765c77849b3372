#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>

#include "backlash/orbit_continuation.hpp"
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
  std::string restitution, from, to;
  std::string output = "x1", longest_period = "4", most_impacts = "16";
};

int small_count(std::string_view name, const std::string& text, std::size_t lowest) {
  constexpr std::size_t highest = 1000;
  const std::size_t value = count_option(name, text, lowest);
  if (value > highest)
    throw std::invalid_argument(std::string(name) + " " + text + ": expected at most " + std::to_string(highest));
  return static_cast<int>(value);
}

int run_orbits(const OrbitsOptions& given) {
  const io::OutputFile file(given.common.out);
  const backlash::TwoMassSystem system = system_of(given.scene, given.restitution);
  backlash::OrbitContinuationOptions options;
  options.output = backlash::output_from_string(given.output);
  options.longest_period = small_count("--longest-period", given.longest_period, 1);
  options.most_impacts = small_count("--most-impacts", given.most_impacts, 2);
  options.threads = given.common.threads;
  frac::Progress progress;
  const auto diagram = [&] {
    const io::ProgressBar bar("orbits", progress, !given.common.quiet);
    return backlash::orbit_diagram(system, number_option("--force", given.scene.force),
                                   number_option("--from", given.from), number_option("--to", given.to), options,
                                   &progress);
  }();
  const std::string command = scene_command("orbits", given.scene)
                                  .option("--restitution", given.restitution)
                                  .option("--from", given.from)
                                  .option("--to", given.to)
                                  .option("--output", given.output)
                                  .option("--longest-period", given.longest_period)
                                  .option("--most-impacts", given.most_impacts)
                                  .text();
  file.write(given.common.format == "json" ? orbits_json(diagram, command) : orbits_csv(diagram, command));
  if (diagram.branches.empty()) {
    say(given.common, "no periodic orbit without rests between these frequencies");
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
  auto* orbits = program.add_subcommand(
      "orbits", "Branches of periodic orbits over frequency, stable and unstable, with their bifurcations");
  orbits->add_option("--restitution", given->restitution, "Coefficient of restitution, 0 to 1")
      ->required()
      ->type_name("EPS");
  orbits->add_option("--from", given->from, "Lowest angular frequency, rad/s")->required()->type_name("W");
  orbits->add_option("--to", given->to, "Highest angular frequency, rad/s")->required()->type_name("W");
  add_scene_options(*orbits, given->scene);
  orbits->add_option("--output", given->output, "Position read: x1 or x2")->capture_default_str()->type_name("x1|x2");
  orbits->add_option("--longest-period", given->longest_period, "Force periods of the longest orbits kept")
      ->capture_default_str()
      ->type_name("N");
  orbits->add_option("--most-impacts", given->most_impacts, "Impacts of the longest orbits kept")
      ->capture_default_str()
      ->type_name("N");
  add_common_options(*orbits, given->common, {"csv", "json"});
  orbits->footer(
      "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
      "Examples:\n"
      "  fracfit orbits --restitution 0.6 --from 1.3 --to 2.5\n"
      "  fracfit orbits --restitution 0.6 --force 40 --clearance 0.3 --from 14 --to 25 --format json --out "
      "orbits.json");
  orbits->callback([given, &run] { run = [given] { return run_orbits(*given); }; });
}

}  // namespace fracfit
