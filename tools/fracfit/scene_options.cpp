#include "scene_options.hpp"

#include <CLI/CLI.hpp>

namespace fracfit {

void add_scene_options(CLI::App& subcommand, SceneOptions& scene) {
  subcommand.add_option("--force", scene.force, "Force amplitude on mass 2, N, > 0")
      ->capture_default_str()
      ->type_name("F");
  subcommand.add_option("--clearance", scene.clearance, "Clearance, m, > 0")->capture_default_str()->type_name("DELTA");
  subcommand.add_option("--m1", scene.mass1, "Mass 1, kg")->capture_default_str()->type_name("M1");
  subcommand.add_option("--m2", scene.mass2, "Mass 2, kg")->capture_default_str()->type_name("M2");
}

backlash::TwoMassSystem system_of(const SceneOptions& scene, const std::string& restitution) {
  return {number_option("--m1", scene.mass1), number_option("--m2", scene.mass2),
          number_option("--clearance", scene.clearance), number_option("--restitution", restitution)};
}

CommandLine scene_command(const std::string& subcommand, const SceneOptions& scene) {
  CommandLine command(subcommand);
  command.option("--force", scene.force)
      .option("--clearance", scene.clearance)
      .option("--m1", scene.mass1)
      .option("--m2", scene.mass2);
  return command;
}

}  // namespace fracfit
