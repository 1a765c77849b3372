// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <stdexcept>

#include "choice.hpp"
#include "exit_code.hpp"
#include "fit_output.hpp"
#include "fit_request.hpp"
#include "fit_statistics.hpp"
#include "frac/structure.hpp"
#include "io/time_series_file.hpp"
#include "json_output.hpp"
#include "model_choice.hpp"
#include "subcommand.hpp"
#include "time_request.hpp"

namespace fracfit {
namespace {

struct FitArguments {
  CommonOptions common;
  FitRequest request;
  std::optional<std::string> model, grow;  // one of them
  ParameterOptions parameters;
  TimeRequest over_time;
  bool profile = false;
  std::string bootstrap;
};

void check(const FitArguments& given) {
  if (given.model.has_value() == given.grow.has_value())
    throw std::invalid_argument("give either --model or --grow: the structure, or the family to grow it in");
  if (!given.grow) return;
  for (const auto& [name, values] :
       {std::pair{"--fix", &given.parameters.fix}, std::pair{"--bound", &given.parameters.bound},
        std::pair{"--start", &given.parameters.start}})
    if (!values->empty())
      throw std::invalid_argument(std::string(name) +
                                  " has no meaning with --grow, whose parameters differ from structure to structure");
}

// Adds what was asked of the fit itself to a command line with data, model and residuals.
std::string completed(CommandLine command, const FitArguments& given) {
  for (const auto& text : given.parameters.bound) command.option("--bound", text);
  for (const auto& text : given.parameters.fix) command.option("--fix", text);
  for (const auto& text : given.parameters.start) command.option("--start", text);
  if (given.profile) command.flag("--profile");
  if (!given.bootstrap.empty()) command.option("--bootstrap", given.bootstrap);
  return command.text();
}

CommandLine command_start(const FitArguments& given) {
  CommandLine command("fit");
  command.argument(given.request.data);
  if (!given.grow) command.option("--model", *given.model);
  if (given.grow) command.option("--grow", *given.grow);
  return command;
}

struct Fitted {
  frac::FitResult result;
  std::optional<frac::Growth> growth;
};

// Leaves in `options` the constraints the fit was made with.
template <class Data, class Options>
Fitted fitted(const FitArguments& given, const Data& data, Options& options) {
  if (!given.grow) {
    const auto model = chosen_model(*given.model);
    return {frac::fit(data, frac::Structure(model.formula), options), std::nullopt};
  }
  const auto family = frac::growth_family_from_string(*given.grow);
  auto growth = frac::grow(data, family, options);
  options.constraints = frac::grown_model(family, growth.chosen + 1).constraints;
  auto result = growth.fits.at(growth.chosen);
  return {std::move(result), std::move(growth)};
}

template <class Data, class Options>
int fit_and_write(const FitArguments& given, const io::OutputFile& out, const Data& data, Options options,
                  const FitRun& run) {
  constexpr std::size_t fewest_samples = 20;
  const StatisticsRequest request{
      given.profile, given.bootstrap.empty() ? 0 : count_option("--bootstrap", given.bootstrap, fewest_samples)};
  const auto [result, growth] = fitted(given, data, options);
  auto statistics = fit_statistics(data, options, result, request, given.common.threads);
  statistics.growth = growth;
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json"  ? fit_json(run, result, statistics)
            : format == "csv" ? fit_csv(run, result, statistics)
                              : fit_table(run, result, statistics));
  if (result.termination == frac::FitTermination::converged) return usable_result;
  say(given.common, "no usable result: " + result.message);
  return no_usable_result;
}

// Parsed before the data are read.
std::vector<frac::ParameterConstraint> given_constraints(const FitArguments& given) {
  if (given.grow) {
    static_cast<void>(frac::growth_family_from_string(*given.grow));
    return {};
  }
  const auto model = chosen_model(*given.model);
  const frac::Structure parsed(model.formula);
  return constraints_of(model, given.parameters);
}

int run_fit(const FitArguments& given) {
  check(given);
  const io::OutputFile out(given.common.out, {given.request.data});
  if (io::holds_time_response(given.request.data)) {
    refuse_frequency_options(given.request);
    const auto options = time_fit_options(given.request, given.over_time, given_constraints(given));
    const auto record = read_time_record(given.request, given.over_time, given.common);
    auto command = command_start(given);
    append_to(command, given.request, record, options);
    return fit_and_write(given, out, record.data, options,
                         time_fit_run(given.request, record, options, completed(command, given)));
  }
  refuse_time_options(given.over_time);
  auto options = fit_options(given.request);
  options.constraints = given_constraints(given);
  const auto file = read_data(given.request, given.common);
  auto command = command_start(given);
  append_to(command, given.request, options);
  return fit_and_write(given, out, file.data, options,
                       fit_run(given.request, options, file, completed(command, given)));
}

}  // namespace

void add_fit(CLI::App& program, Run& run) {
  const auto given = std::make_shared<FitArguments>();
  auto* fit = program.add_subcommand(
      "fit", "Fits one structure to a frequency response, or to samples of input and output over time");
  add_fit_options(*fit, given->request);
  fit->add_option("--model", given->model,
                  "Preset or formula of s and named parameters, e.g. 'K exp(-L s)/(T s^a + 1)'")
      ->type_name("MODEL")
      ->check(suggest(preset_names()));
  fit->add_option("--grow", given->grow,
                  "Instead of --model a family, grown by a term at a time while the data pay for it")
      ->type_name("FAMILY")
      ->check(one_of(spellings(frac::growth_families())));
  add_repeatable(*fit, "--fix", given->parameters.fix, "Hold a parameter at a value; repeatable", "NAME=VALUE");
  add_repeatable(*fit, "--bound", given->parameters.bound, "Limit a parameter; one side may be left out; repeatable",
                 "NAME=LOW:HIGH");
  add_repeatable(*fit, "--start", given->parameters.start, "Start a parameter at a value; repeatable", "NAME=VALUE");
  fit->add_flag("--profile", given->profile,
                "Add profile-likelihood intervals of every parameter: they follow the cost itself");
  fit->add_option("--bootstrap", given->bootstrap, "Add intervals from N refits to resampled residuals, N >= 20")
      ->type_name("N");
  add_time_options(*fit, given->over_time);
  add_common_options(*fit, given->common, {"json", "csv", "table"});
  fit->footer(
      "Samples over time take --weight given (the default where the file has a column sigma) or absolute, --where\n"
      "with t (s), input or output (the input drives the model throughout), and none of --component, --realisation,\n"
      "--band, --poles, --sample-time and --memory.\n"
      "Presets:\n" +
      preset_list() +
      "Examples:\n"
      "  fracfit fit curve.csv --model power-law --where 'omega<4'\n"
      "  fracfit fit cell.csv --model 'R0 + R1/(1 + R1 Q1 s^n1)' --component both --bound n1=:1 --profile\n"
      "  fracfit fit cell.csv --grow arcs --component both\n"
      "  fracfit fit step.csv --model 'K exp(-L s)/(T s^a + 1)'      # columns time_s,input,output\n"
      "  fracfit fit curve.csv --model 'K/(T s^a + 1)' --where 'omega<4' --realisation oustaloup --band 0.01:1000 "
      "--poles 9 "
      "--out fit.json");
  fit->callback([given, &run] { run = [given] { return run_fit(*given); }; });
}

}  // namespace fracfit
