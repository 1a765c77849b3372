#include "backlash/jump_law.hpp"

#include <CLI/CLI.hpp>
#include <memory>

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
};

int run_jump_law(const JumpLawArguments& given) {
  const io::OutputFile out(given.common.out);
  const auto criterion = backlash::jump_criterion_from_string(given.criterion);
  const JumpLawRun run{CommandLine("jump-law")
                           .option("--force", given.force)
                           .option("--clearance", given.clearance)
                           .option("--restitution", given.restitution)
                           .option("--criterion", given.criterion)
                           .option("--m1", given.mass1)
                           .option("--m2", given.mass2)
                           .text(),
                       number_option("--m1", given.mass1), number_option("--m2", given.mass2)};
  frac::Progress progress;
  const auto law = [&] {
    const io::ProgressBar bar("jump-law", progress, !given.common.quiet);
    return backlash::fit_jump_law(
        run.mass1, run.mass2, io::parse_grid(given.force, "--force"), io::parse_grid(given.clearance, "--clearance"),
        io::parse_grid(given.restitution, "--restitution"), criterion, given.common.threads, &progress);
  }();
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? jump_law_json(run, law)
            : format == "csv" ? jump_law_csv(run, law)
                              : jump_law_table(run, law));
  return usable_result;
}

}  // namespace

void add_jump_law(CLI::App& program, Run& run) {
  const auto given = std::make_shared<JumpLawArguments>();
  auto* jump_law = program.add_subcommand("jump-law", "Jump frequency over force and clearance, and its power laws");
  jump_law->add_option("--force", given->force, "Force amplitudes, N: list or grid")
      ->capture_default_str()
      ->type_name("LIST");
  jump_law->add_option("--clearance", given->clearance, "Clearances, m: list or grid")
      ->capture_default_str()
      ->type_name("LIST");
  jump_law->add_option("--restitution", given->restitution, "Coefficients of restitution to average over: list or grid")
      ->capture_default_str()
      ->type_name("LIST");
  jump_law
      ->add_option(
          "--criterion", given->criterion,
          "two-impact-loss, symmetry-loss, saddle-node, contact-at-rest, mid-gap-at-rest, sweep-up, sweep-down or "
          "largest-discontinuity")
      ->capture_default_str()
      ->type_name("C");
  jump_law->add_option("--m1", given->mass1, "Mass 1, kg")->capture_default_str()->type_name("M1");
  jump_law->add_option("--m2", given->mass2, "Mass 2, kg")->capture_default_str()->type_name("M2");
  add_common_options(*jump_law, given->common, {"json", "csv", "table"});
  jump_law->footer(
      "Examples:\n"
      "  fracfit jump-law\n"
      "  fracfit jump-law --criterion symmetry-loss --restitution 0.2,0.4,0.6,0.8 --out law.json\n"
      "  fracfit jump-law --force 10:50:9 --clearance 0.01:0.5:12log --format table");
  jump_law->callback([given, &run] { run = [given] { return run_jump_law(*given); }; });
}

}  // namespace fracfit
