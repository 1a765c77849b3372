// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <CLI/CLI.hpp>
#include <atomic>
#include <memory>
#include <optional>

#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/progress_bar.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct ReportArguments {
  CommonOptions common;
  std::vector<std::string> data;
  std::string scene;
  std::string out;
};

int run_report(const ReportArguments& given) {
  frac::Progress progress;
  std::optional<io::ProgressBar> bar;
  report::ReportOptions options;
  options.out = given.out;
  options.data.assign(given.data.begin(), given.data.end());
  CommandLine command("report");
  for (const auto& file : given.data) command.argument(file);
  if (!given.scene.empty()) {
    options.scene = given.scene;
    command.option("--scene", given.scene);
  }
  options.command = command.option("--out", given.out).text();
  options.threads = given.common.threads;
  options.progress = &progress;
  options.stage = [&](std::string_view name) {
    bar.reset();
    say(given.common, std::string(name));
    bar.emplace(std::string(name), progress, !given.common.quiet);
  };
  const auto outcome = report::write_report(options);
  bar.reset();
  std::fprintf(stderr, "fracfit: %s\n", outcome.message.c_str());
  return outcome.pictures ? usable_result : no_usable_result;
}

}  // namespace

void add_report(CLI::App& program, Run& run) {
  const auto given = std::make_shared<ReportArguments>();
  auto* report =
      program.add_subcommand("report", "Writes the whole study as one page with figures, tables and numbers");
  auto* data =
      report
          ->add_option("DATA", given->data,
                       "Measured frequency responses, or samples over time (time_s,input,output); without any, "
                       "the paper's scenes")
          ->type_name("FILE");
  report->add_option("--scene", given->scene, "Scene as JSON: m1, m2, clearance, restitution, force, omega")
      ->excludes(data)
      ->type_name("FILE");
  report->add_option("--out", given->out, "Folder to write, made if missing")
      ->required()
      ->type_name("DIR")
      ->check(not_empty());
  add_common_options(*report, given->common, {});
  report->footer(
      "Examples:\n"
      "  fracfit report --out report\n"
      "  fracfit report cell.csv --out cell-report\n"
      "  fracfit report step.csv --out step-report      # columns time_s,input,output\n"
      "  fracfit report --scene scene.json --out scene-report");
  report->callback([given, &run] { run = [given] { return run_report(*given); }; });
}

}  // namespace fracfit
