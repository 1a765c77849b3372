// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/number_list.hpp"
#include "io/progress_bar.hpp"
#include "json_output.hpp"
#include "jump_law_output.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct JumpLawArguments {
  CommonOptions common;
  // Grid of the paper's figs. 9 and 10.
  std::string force = "10,20,30,40,50";
  std::string clearance = "0.01,0.025,0.05,0.1,0.2,0.3,0.4,0.5";
  std::string restitution = "0,0.2,0.4,0.6,0.8,1";
  std::string criterion = "two-impact-loss";
  std::string mass1 = "1", mass2 = "1";
  bool constants = false;
};

void put_scenes(CommandLine& command, const JumpLawArguments& given) {
  command.option("--force", given.force).option("--clearance", given.clearance);
  command.option("--m1", given.mass1).option("--m2", given.mass2);
}

template <class Function>
auto over_grid(Function function, const JumpLawArguments& given, backlash::JumpCriterion criterion,
               frac::Progress& progress) {
  const auto force = io::parse_grid(given.force, "--force");
  const auto clearance = io::parse_grid(given.clearance, "--clearance");
  const auto restitution = io::parse_grid(given.restitution, "--restitution");
  require_table_size(
      {{"--force", force.size()}, {"--clearance", clearance.size()}, {"--restitution", restitution.size()}});
  return function(number_option("--m1", given.mass1), number_option("--m2", given.mass2), force, clearance, restitution,
                  criterion, given.common.threads, &progress);
}

bool depends_on_restitution_alone(backlash::JumpCriterion criterion) {
  return criterion != backlash::JumpCriterion::largest_discontinuity;
}

int run_constants(const JumpLawArguments& given, bool scene_given) {
  const io::OutputFile out(given.common.out);
  const auto criterion = backlash::jump_criterion_from_string(given.criterion);
  CommandLine command("jump-law");
  command.flag("--constants").option("--restitution", given.restitution).option("--criterion", given.criterion);
  if (!depends_on_restitution_alone(criterion)) put_scenes(command, given);
  frac::Progress progress;
  const auto grid = [&] {
    const io::ProgressBar bar("jump-law", progress, !given.common.quiet);
    return over_grid(backlash::jump_grid, given, criterion, progress);
  }();
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? jump_constants_json(command.text(), grid)
            : format == "csv" ? jump_constants_csv(command.text(), grid)
                              : jump_constants_table(grid));
  if (scene_given && depends_on_restitution_alone(criterion))
    say(given.common,
        "by criterion " + given.criterion +
            " the constants depend on restitution alone; --force, --clearance, --m1 and --m2 do not change them");
  if (averaged_count(grid) > 0) return usable_result;
  say(given.common, "no restitution has a jump by this criterion");
  return no_usable_result;
}

int run_laws(const JumpLawArguments& given) {
  const io::OutputFile out(given.common.out);
  const auto criterion = backlash::jump_criterion_from_string(given.criterion);
  CommandLine command("jump-law");
  command.option("--restitution", given.restitution).option("--criterion", given.criterion);
  put_scenes(command, given);
  const JumpLawRun run{command.text(), number_option("--m1", given.mass1), number_option("--m2", given.mass2)};
  frac::Progress progress;
  const auto law = [&] {
    const io::ProgressBar bar("jump-law", progress, !given.common.quiet);
    return over_grid(backlash::fit_jump_law, given, criterion, progress);
  }();
  const std::string format = chosen_format(given.common, "json");
  if (law.message.empty() || format != "table") {
    out.write(format == "json"  ? jump_law_json(run, law)
              : format == "csv" ? jump_law_csv(run, law)
                                : jump_law_table(run, law));
  }
  if (law.message.empty()) return usable_result;
  say(given.common, law.message);
  return no_usable_result;
}

}  // namespace

void add_jump_law(CLI::App& program, Run& run) {
  const auto given = std::make_shared<JumpLawArguments>();
  auto* jump_law = program.add_subcommand("jump-law", "Jump frequency over force and clearance, and its power laws");
  const std::vector<CLI::Option*> scene{
      jump_law->add_option("--force", given->force, "Force amplitudes, N: list or grid")->type_name("LIST"),
      jump_law->add_option("--clearance", given->clearance, "Clearances, m: list or grid")->type_name("LIST"),
      jump_law->add_option("--m1", given->mass1, "Mass 1, kg")->type_name("M1"),
      jump_law->add_option("--m2", given->mass2, "Mass 2, kg")->type_name("M2")};
  for (CLI::Option* option : scene) option->capture_default_str();
  jump_law->add_option("--restitution", given->restitution, "Coefficients of restitution to average over: list or grid")
      ->capture_default_str()
      ->type_name("LIST");
  jump_law->add_option("--criterion", given->criterion, "What counts as the jump")
      ->capture_default_str()
      ->type_name("C")
      ->check(one_of(spellings(backlash::jump_criteria())));
  jump_law->add_flag("--constants", given->constants,
                     "Instead of the laws c = w_J/sqrt(F/(M2 Delta)) over restitution, with what happens at each jump");
  add_common_options(*jump_law, given->common, {"json", "csv", "table"});
  jump_law->footer(
      "Examples:\n"
      "  fracfit jump-law\n"
      "  fracfit jump-law --criterion symmetry-loss --restitution 0.2,0.4,0.6,0.8 --out law.json\n"
      "  fracfit jump-law --force 10:50:9 --clearance 0.01:0.5:12log --format table\n"
      "  fracfit jump-law --constants --restitution 0:1:101 --format csv --out constants.csv");
  jump_law->callback([given, scene, &run] {
    const bool scene_given =
        std::any_of(scene.begin(), scene.end(), [](const auto* option) { return !option->empty(); });
    run = [given, scene_given] { return given->constants ? run_constants(*given, scene_given) : run_laws(*given); };
  });
}

}  // namespace fracfit
