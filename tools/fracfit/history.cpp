// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>

#include "backlash/time_history.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/number.hpp"
#include "io/sweep_file.hpp"
#include "scene_options.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct HistoryOptions {
  CommonOptions common;
  SceneOptions scene;
  std::string restitution, omega;
  std::string position, velocity = "0", periods = "5", samples = "100", skip = "0";
};

std::string csv(const backlash::TimeHistory& history, const io::Metadata& scene, const std::string& command) {
  std::string text = io::header_lines(scene, command);
  text += "time_s,x1_m,v1_m_s,x2_m,v2_m_s,event,contact\n";
  for (const auto& row : history.rows) {
    for (const double value : {row.time, row.x1, row.v1, row.x2, row.v2}) {
      io::append_number(text, value);
      text += ',';
    }
    text += backlash::to_string(row.event);
    text += !row.wall ? ",none\n" : *row.wall == backlash::Wall::near ? ",near\n" : ",far\n";
  }
  return text;
}

constexpr int skipped_at_once = 1000;

int run_history(const HistoryOptions& given) {
  const io::OutputFile file(given.common.out);
  const backlash::TwoMassSystem system = system_of(given.scene, given.restitution);
  const double force = number_option("--force", given.scene.force);
  const double omega = number_option("--omega", given.omega);
  const std::size_t periods = count_option("--periods", given.periods, 1);
  const std::size_t samples = count_option("--samples", given.samples, 1);
  require_table_size({{"--periods", periods}, {"--samples", samples}});
  constexpr std::size_t longest_skip = std::numeric_limits<int>::max();
  const auto skip = static_cast<int>(count_option("--skip", given.skip, 0, longest_skip));
  backlash::RelativeState start{
      given.position.empty() ? 0.5 * system.clearance() : number_option("--position", given.position),
      number_option("--velocity", given.velocity)};
  const std::string command = scene_command("history", given.scene)
                                  .option("--restitution", given.restitution)
                                  .option("--omega", given.omega)
                                  .option("--position", io::format_number(start.position))
                                  .option("--velocity", given.velocity)
                                  .option("--skip", given.skip)
                                  .option("--periods", given.periods)
                                  .option("--samples", given.samples)
                                  .text();
  // In parts, so that their impacts need not all be kept.
  for (int left = skip; left > 0; left -= skipped_at_once) {
    const auto before = backlash::simulate_impacts(system, force, omega, start, std::min(left, skipped_at_once));
    if (!before.complete) {
      say(given.common, std::to_string(std::min(left, skipped_at_once)) + " of the periods to skip hold more than " +
                            std::to_string(before.impacts.size()) + " impacts");
      return no_usable_result;
    }
    start = before.end;
  }
  const auto history =
      backlash::time_history(system, force, omega, start, static_cast<int>(periods), static_cast<int>(samples));
  const io::Metadata scene{{"mass1_kg", io::format_number(system.mass1())},
                           {"mass2_kg", io::format_number(system.mass2())},
                           {"clearance_m", io::format_number(system.clearance())},
                           {"force_n", io::format_number(force)},
                           {"restitution", io::format_number(system.restitution())},
                           {"omega_rad_s", io::format_number(omega)},
                           {"start_position_m", io::format_number(start.position)},
                           {"start_velocity_m_s", io::format_number(start.velocity)},
                           {"complete", history.complete ? "yes" : "no"}};
  file.write(csv(history, scene, command));
  if (!history.complete) say(given.common, "ended early, at the millionth impact");
  return usable_result;
}

}  // namespace

void add_history(CLI::App& program, Run& run) {
  const auto given = std::make_shared<HistoryOptions>();
  auto* history = program.add_subcommand(
      "history", "Positions and velocities of two masses with backlash over time, exact at every impact");
  add_scene_options(*history, given->scene);
  history->add_option("--restitution", given->restitution, "Coefficient of restitution, 0 to 1")
      ->required()
      ->type_name("EPS");
  history->add_option("--omega", given->omega, "Angular frequency of the force, rad/s")->required()->type_name("W");
  history->add_option("--position", given->position, "x2 - x1 at the start, m (default: mid-gap)")->type_name("Y");
  history->add_option("--velocity", given->velocity, "x2' - x1' at the start, m/s")
      ->capture_default_str()
      ->type_name("V");
  history->add_option("--skip", given->skip, "Force periods to follow before the first row")
      ->capture_default_str()
      ->type_name("N");
  history->add_option("--periods", given->periods, "Force periods to write")->capture_default_str()->type_name("N");
  history->add_option("--samples", given->samples, "Rows per period, besides two per impact")
      ->capture_default_str()
      ->type_name("N");
  add_common_options(*history, given->common, {"csv"});
  history->footer(
      "Time begins where the force F cos(w t) on mass 2 is at its peak; positions are those about the mean of the\n"
      "centre of mass.  Column event: sample, before-impact, after-impact, rest-begin, release.\n"
      "Examples:\n"
      "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 20 --skip 200 --periods 2\n"
      "  fracfit history --force 40 --clearance 0.3 --restitution 0.6 --omega 2 --periods 2 --out chatter.csv");
  history->callback([given, &run] { run = [given] { return run_history(*given); }; });
}

}  // namespace fracfit
