// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "backlash/regime_map.hpp"
#include "batch_table.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/map_file.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/progress_bar.hpp"
#include "scene_options.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct MapOptions {
  CommonOptions common;
  SceneOptions scene;
  std::string restitution, omega;
  std::string output = "x1", protocol = "sweep-up", tolerance, mean_tolerance, shard;
};

int run_map(const MapOptions& given) {
  const io::OutputFile file(given.common.out);
  const backlash::MapScene scene{number_option("--m1", given.scene.mass1), number_option("--m2", given.scene.mass2),
                                 number_option("--clearance", given.scene.clearance),
                                 number_option("--force", given.scene.force)};
  backlash::SweepOptions options = backlash::map_options();
  options.output = backlash::output_from_string(given.output);
  options.protocol = backlash::protocol_from_string(given.protocol);
  if (!given.tolerance.empty()) options.tolerance = number_option("--tolerance", given.tolerance);
  if (!given.mean_tolerance.empty()) options.mean_tolerance = number_option("--mean-tolerance", given.mean_tolerance);
  options.threads = given.common.threads;
  const std::vector<double> omega = io::parse_grid(given.omega, "--omega");
  const std::vector<double> all = io::parse_grid(given.restitution, "--restitution");
  const io::Shard shard = shard_option(given.shard);
  const std::vector<double> restitution = io::part_of(all, shard);
  if (restitution.empty())
    throw std::invalid_argument("--shard " + given.shard + ": there are only " + std::to_string(all.size()) +
                                " restitutions to share");
  require_table_size({{"--restitution", restitution.size()}, {"--omega", omega.size()}});

  frac::Progress progress;
  const auto map = [&] {
    const io::ProgressBar bar("map", progress, !given.common.quiet);
    return backlash::regime_map(scene, restitution, omega, options, &progress);
  }();
  const std::string command = scene_command("map", given.scene)
                                  .option("--restitution", given.restitution)
                                  .option("--omega", given.omega)
                                  .option("--output", given.output)
                                  .option("--protocol", given.protocol)
                                  .option("--tolerance", io::format_number(options.tolerance))
                                  .option("--mean-tolerance", io::format_number(options.mean_tolerance))
                                  .text();
  file.write(io::map_csv(map, command, shard));
  const bool usable = std::all_of(map.points.begin(), map.points.end(), [](const auto& point) {
    return std::isfinite(point.value.real()) && std::isfinite(point.value.imag());
  });
  if (!usable) say(given.common, "some points have no finite value, see the output");
  return usable ? usable_result : no_usable_result;
}

}  // namespace

void add_map(CLI::App& program, Run& run) {
  const auto given = std::make_shared<MapOptions>();
  auto* map =
      program.add_subcommand("map", "N, regime and error of two masses with backlash over restitution and frequency");
  add_scene_options(*map, given->scene);
  map->add_option("--restitution", given->restitution, "Coefficients of restitution, 0 to 1: grid or list")
      ->required()
      ->type_name("GRID");
  map->add_option("--omega", given->omega, "Angular frequencies, rad/s: FROM:TO:COUNT, FROM:TO:COUNTlog or a list")
      ->required()
      ->type_name("GRID");
  map->add_option("--output", given->output, "Position read")
      ->capture_default_str()
      ->type_name("MASS")
      ->check(one_of(spellings(backlash::outputs())));
  map->add_option("--protocol", given->protocol, "Where the motion starts")
      ->capture_default_str()
      ->type_name("P")
      ->check(one_of(spellings(backlash::protocols())));
  map->add_option("--tolerance", given->tolerance, "Closure of an orbit, relative to the clearance (default 1e-10)")
      ->type_name("T");
  map->add_option("--mean-tolerance", given->mean_tolerance,
                  "Uncertainty over |N| at which a long-time mean ends; 0 for a thousand periods each (default 0.01)")
      ->type_name("T");
  map->add_option("--shard", given->shard,
                  "Work on every n-th restitution only, from the i-th; join with fracfit merge")
      ->type_name("i/n");
  add_common_options(*map, given->common, {"csv"});
  map->footer(
      "With force, clearance and masses 1 the frequency is that over sqrt(F/(M2 Delta)).\n"
      "Examples:\n"
      "  fracfit map --restitution 0:1:251 --omega 0.5:4:400log --out map.csv\n"
      "  fracfit map --force 40 --clearance 0.3 --restitution 0:0.95:20 --omega 5:35:200log --shard 1/2 --out "
      "part1.csv\n"
      "  fracfit merge map.csv part1.csv part2.csv");
  map->callback([given, &run] { run = [given] { return run_map(*given); }; });
}

}  // namespace fracfit
