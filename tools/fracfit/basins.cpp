// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/number.hpp"
#include "io/number_list.hpp"
#include "io/progress_bar.hpp"
#include "io/sweep_file.hpp"
#include "json_number.hpp"
#include "report/grid.hpp"
#include "scene_options.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct BasinOptions {
  CommonOptions common;
  SceneOptions scene;
  std::string restitution, omega, position, velocity;
  std::string output = "x1";
};

io::Metadata scene_of(const backlash::BasinMap& map, backlash::Output output) {
  return {
      {"mass1_kg", io::format_number(map.system.mass1())},          {"mass2_kg", io::format_number(map.system.mass2())},
      {"clearance_m", io::format_number(map.system.clearance())},   {"force_n", io::format_number(map.force_amplitude)},
      {"restitution", io::format_number(map.system.restitution())}, {"omega_rad_s", io::format_number(map.omega)},
      {"output", std::string(backlash::to_string(output))}};
}

// What the starts are told apart by.
std::string motion_name(const backlash::BasinMap& map) {
  return map.attracts() ? "attractor" : "motion";
}

constexpr const char* no_attractor =
    "at restitution 1 impacts lose no energy and nothing attracts: the motions listed are those of these starts, told "
    "apart by their long-time means; other starts have others";

double share_of(const backlash::BasinMap& map, const backlash::Attractor& attractor) {
  return static_cast<double>(attractor.starts) / static_cast<double>(map.attractor.size());
}

std::string csv(const backlash::BasinMap& map, backlash::Output output, const std::string& command) {
  io::Metadata entries = scene_of(map, output);
  if (!map.attracts()) entries.emplace_back("note", no_attractor);
  for (std::size_t i = 0; i < map.attractors.size(); ++i) {
    const auto& [point, symmetric, starts] = map.attractors[i];
    entries.emplace_back(
        motion_name(map) + " " + std::to_string(i),
        "share " + io::format_number(share_of(map, map.attractors[i])) + ", regime " +
            std::string(backlash::to_string(point.regime)) + ", period " + std::to_string(point.period) +
            ", impacts per period " + io::format_number(point.impacts_per_period) +
            (symmetric ? ", symmetric" : ", asymmetric") + ", N " + io::format_number(point.value.real()) +
            (std::signbit(point.value.imag()) ? " - " : " + ") + io::format_number(std::abs(point.value.imag())) +
            " j m/N, uncertainty " + io::format_number(point.uncertainty) +
            (point.transient_possible
                 ? ", transient not excluded after " + io::format_number(point.periods_followed) + " periods"
                 : ""));
  }
  std::string text = io::header_lines(entries, command);
  text += "position_m,velocity_m_s," + motion_name(map) + "\n";
  for (std::size_t i = 0; i < map.attractor.size(); ++i) {
    io::append_number(text, map.position[i / map.velocity.size()]);
    text += ',';
    io::append_number(text, map.velocity[i % map.velocity.size()]);
    text += "," + std::to_string(map.attractor[i]) + "\n";
  }
  return text;
}

std::string json(const backlash::BasinMap& map, backlash::Output output, const std::string& command) {
  Json result{{"fracfit", io::version()}, {"command", command}};
  for (const auto& [key, value] : scene_of(map, output)) {
    const auto parsed = io::parse_number(value);
    result["scene"][key] = parsed ? Json(*parsed) : Json(value);
  }
  if (!map.attracts()) result["note"] = no_attractor;
  Json& motions = result[motion_name(map) + "s"] = Json::array();
  for (const auto& attractor : map.attractors)
    motions.push_back({{"share", share_of(map, attractor)},
                       {"starts", attractor.starts},
                       {"regime", backlash::to_string(attractor.point.regime)},
                       {"period", attractor.point.period},
                       {"impacts_per_period", number(attractor.point.impacts_per_period)},
                       {"symmetric", attractor.symmetric},
                       {"re_m_per_n", number(attractor.point.value.real())},
                       {"im_m_per_n", number(attractor.point.value.imag())},
                       {"uncertainty_m_per_n", number(attractor.point.uncertainty)},
                       {"lyapunov_exponent", number(attractor.point.lyapunov_exponent)},
                       {"periods_followed", number(attractor.point.periods_followed)},
                       {"transient_possible", attractor.point.transient_possible}});
  result["position_m"] = map.position;
  result["velocity_m_s"] = map.velocity;
  result[motion_name(map)] = map.attractor;
  return result.dump() + "\n";
}

int run_basins(const BasinOptions& given) {
  const io::OutputFile file(given.common.out);
  const backlash::TwoMassSystem system = system_of(given.scene, given.restitution);
  const double omega = number_option("--omega", given.omega);
  backlash::SweepOptions options;
  options.output = backlash::output_from_string(given.output);
  options.threads = given.common.threads;
  const auto position = given.position.empty() ? report::linear_grid(0, system.clearance(), 41)
                                               : io::parse_grid(given.position, "--position");
  const double speed = system.clearance() * omega;
  const auto velocity =
      given.velocity.empty() ? report::linear_grid(-speed, speed, 41) : io::parse_grid(given.velocity, "--velocity");
  require_table_size({{"--position", position.size()}, {"--velocity", velocity.size()}});
  frac::Progress progress;
  const auto map = [&] {
    const io::ProgressBar bar("basins", progress, !given.common.quiet);
    return backlash::basins(system, number_option("--force", given.scene.force), omega, position, velocity, options,
                            &progress);
  }();
  CommandLine command = scene_command("basins", given.scene);
  command.option("--restitution", given.restitution).option("--omega", given.omega).option("--output", given.output);
  if (!given.position.empty()) command.option("--position", given.position);
  if (!given.velocity.empty()) command.option("--velocity", given.velocity);
  file.write(given.common.format == "json" ? json(map, options.output, command.text())
                                           : csv(map, options.output, command.text()));
  if (!map.attracts()) say(given.common, no_attractor);
  return usable_result;
}

}  // namespace

void add_basins(CLI::App& program, Run& run) {
  const auto given = std::make_shared<BasinOptions>();
  auto* basins = program.add_subcommand(
      "basins", "Which long-run motion of two masses with backlash each start leads to, at one frequency");
  add_scene_options(*basins, given->scene);
  basins->add_option("--restitution", given->restitution, "Coefficient of restitution, 0 to 1")
      ->required()
      ->type_name("EPS");
  basins->add_option("--omega", given->omega, "Angular frequency of the force, rad/s")->required()->type_name("W");
  basins
      ->add_option("--position", given->position,
                   "x2 - x1 where the force is at its peak, m: grid or list (default: 41 from wall to wall)")
      ->type_name("GRID");
  basins
      ->add_option("--velocity", given->velocity,
                   "x2' - x1' there, m/s: grid or list (default: 41 up to clearance times w either way)")
      ->type_name("GRID");
  basins->add_option("--output", given->output, "Position read")
      ->capture_default_str()
      ->type_name("MASS")
      ->check(one_of(spellings(backlash::outputs())));
  add_common_options(*basins, given->common, {"csv", "json"});
  basins->footer(
      "Attractors are numbered by their share of the starts and listed in the header.  At restitution 1 nothing\n"
      "attracts; the motions of the starts are listed instead.\n"
      "Examples:\n"
      "  fracfit basins --restitution 0.6 --omega 1.41\n"
      "  fracfit basins --force 40 --clearance 0.3 --restitution 0.4 --omega 17 --position 0:0.3:101 \\\n"
      "      --velocity -5:5:101 --out basins.csv");
  basins->callback([given, &run] { run = [given] { return run_basins(*given); }; });
}

}  // namespace fracfit
