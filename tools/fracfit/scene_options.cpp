// SPDX-License-Identifier: BSD-3-Clause
#include "scene_options.hpp"

#include <CLI/CLI.hpp>

namespace fracfit {

void add_scene_options(CLI::App& subcommand, SceneOptions& scene) {
  subcommand.add_option("--force", scene.force, "Force amplitude on mass 2, N, > 0")
      ->capture_default_str()
      ->type_name("F");
  subcommand.add_option("--clearance", scene.clearance, "Clearance, m, > 0; 0 in a map too")
      ->capture_default_str()
      ->type_name("DELTA");
  subcommand.add_option("--m1", scene.mass1, "Mass 1, kg")->capture_default_str()->type_name("M1");
  subcommand.add_option("--m2", scene.mass2, "Mass 2, kg")->capture_default_str()->type_name("M2");
}

backlash::TwoMassSystem system_of(const SceneOptions& scene, const std::string& restitution) {
  return {number_option("--m1", scene.mass1), number_option("--m2", scene.mass2),
          number_option("--clearance", scene.clearance), number_option("--restitution", restitution)};
}

CommandLine scene_command(const std::string& subcommand, const SceneOptions& scene, const std::string& left_out) {
  CommandLine command(subcommand);
  if (left_out != "force") command.option("--force", scene.force);
  if (left_out != "clearance") command.option("--clearance", scene.clearance);
  return command.option("--m1", scene.mass1).option("--m2", scene.mass2);
}

}  // namespace fracfit
