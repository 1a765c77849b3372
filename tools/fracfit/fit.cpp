#include <CLI/CLI.hpp>
#include <memory>

#include "exit_code.hpp"
#include "fit_output.hpp"
#include "fit_request.hpp"
#include "frac/structure.hpp"
#include "json_output.hpp"
#include "model_choice.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct FitArguments {
  CommonOptions common;
  FitRequest request;
  std::string model;
  ParameterOptions parameters;
};

std::string command_of(const FitArguments& given, const frac::FitOptions& options) {
  CommandLine command("fit");
  command.argument(given.request.data).option("--model", given.model);
  append_to(command, given.request, options);
  for (const auto& text : given.parameters.bound) command.option("--bound", text);
  for (const auto& text : given.parameters.fix) command.option("--fix", text);
  for (const auto& text : given.parameters.start) command.option("--start", text);
  return command.text();
}

int run_fit(const FitArguments& given) {
  const io::OutputFile out(given.common.out);
  auto options = fit_options(given.request);
  const auto model = chosen_model(given.model);
  options.constraints = constraints_of(model, given.parameters);
  const frac::Structure structure(model.formula);
  const auto file = read_data(given.request, given.common);
  const auto result = frac::fit(file.data, structure, options);

  const FitRun run = fit_run(given.request, options, file, command_of(given, options));
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json" ? fit_json(run, result) : format == "csv" ? fit_csv(run, result) : fit_table(run, result));
  if (result.termination == frac::FitTermination::converged) return usable_result;
  say(given.common, "no usable result: " + result.message);
  return no_usable_result;
}

}  // namespace

void add_fit(CLI::App& program, Run& run) {
  const auto given = std::make_shared<FitArguments>();
  auto* fit = program.add_subcommand("fit", "Fits one structure to a frequency response");
  add_fit_options(*fit, given->request);
  fit->add_option("--model", given->model,
                  "Preset or formula of s and named parameters, e.g. 'K exp(-L s)/(T s^a + 1)'")
      ->required()
      ->type_name("MODEL");
  add_repeatable(*fit, "--fix", given->parameters.fix, "Hold a parameter at a value; repeatable", "NAME=VALUE");
  add_repeatable(*fit, "--bound", given->parameters.bound, "Limit a parameter; one side may be left out; repeatable",
                 "NAME=LOW:HIGH");
  add_repeatable(*fit, "--start", given->parameters.start, "Start a parameter at a value; repeatable", "NAME=VALUE");
  add_common_options(*fit, given->common, {"json", "csv", "table"});
  fit->footer("Presets:\n" + preset_list() +
              "Examples:\n"
              "  fracfit fit curve.csv --model power-law --where 'omega>20'\n"
              "  fracfit fit cell.csv --model 'R0 + R1/(1 + R1 Q1 s^n1)' --component both --bound n1=:1\n"
              "  fracfit fit curve.csv --model 'K/(T s^a + 1)' --realisation oustaloup --band 0.01:1000 --poles 9 "
              "--out fit.json");
  fit->callback([given, &run] { run = [given] { return run_fit(*given); }; });
}

}  // namespace fracfit
