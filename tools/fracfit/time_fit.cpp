#include "time_fit.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "choice.hpp"
#include "exit_code.hpp"
#include "frac/identification/time_fit.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/time_series_file.hpp"
#include "json_output.hpp"

namespace fracfit {
namespace {

void refuse_options_over_frequency(const FitRequest& request) {
  const auto refuse = [](bool given, const char* option) {
    if (given)
      throw std::invalid_argument(std::string(option) +
                                  " has no meaning with samples over time, only with a frequency response");
  };
  refuse(!request.component.empty(), "--component");
  refuse(request.realisation != "exact", "--realisation");
  refuse(!request.band.empty(), "--band");
  refuse(!request.poles.empty(), "--poles");
  refuse(!request.sample_time.empty(), "--sample-time");
  refuse(!request.memory.empty(), "--memory");
  refuse(!request.where.empty(), "--where");
  refuse(request.loss != "none", "--loss");
}

// "given" or "absolute".
std::string weight_of(const FitRequest& request, const io::TimeSeries& series) {
  if (!request.weight_is_given) return series.sigma.empty() ? "absolute" : "given";
  if (request.weight == "absolute") return request.weight;
  if (request.weight != "given")
    throw std::invalid_argument("--weight " + io::quoted(request.weight) +
                                ": expected given or absolute with samples over time");
  if (series.sigma.empty())
    throw io::DataError(request.data, 0, 0, "has no column sigma; expected one with --weight given");
  return request.weight;
}

frac::Hold hold_of(const std::string& text) {
  return text == "first-order" ? frac::Hold::first_order : frac::Hold::zero_order;
}

}  // namespace

void add_time_fit_options(CLI::App& subcommand, TimeFitRequest& request) {
  subcommand
      .add_option("--hold", request.hold, "Samples over time: how the input runs between them (default zero-order)")
      ->type_name("HOLD")
      ->check(one_of({"zero-order", "first-order"}));
  subcommand
      .add_option("--offset", request.offset,
                  "Samples over time: what the output shows at rest, free (estimated, default) or a number")
      ->type_name("VALUE")
      ->check(suggest({"free"}));
  subcommand
      .add_option("--input-at-rest", request.input_at_rest,
                  "Samples over time: the input before the first sample, 0 if not given")
      ->type_name("VALUE");
}

int run_time_fit(const io::OutputFile& out, const CommonOptions& common, const FitRequest& request,
                 const TimeFitRequest& over_time, const std::string& model_text, const ParameterOptions& parameters) {
  refuse_options_over_frequency(request);
  const auto model = chosen_model(model_text);
  const frac::Structure structure(model.formula);
  frac::TimeFitOptions options;
  options.constraints = constraints_of(model, parameters);
  options.seed = seed_of(request);
  if (!over_time.offset.empty() && over_time.offset != "free")
    options.offset = number_option("--offset", over_time.offset);
  const frac::Hold hold = hold_of(over_time.hold);
  const double at_rest =
      over_time.input_at_rest.empty() ? 0 : number_option("--input-at-rest", over_time.input_at_rest);

  io::TimeSeries series = io::read_time_response(request.data);
  for (const auto& note : series.notes) say(common, request.data + ": " + note);
  const std::string weight = weight_of(request, series);
  if (weight == "absolute") series.sigma.clear();
  const io::Metadata header = series.metadata;
  const frac::TimeResponseData data(std::move(series.time), std::move(series.input), std::move(series.output),
                                    std::move(series.sigma), hold, at_rest);
  const frac::FitResult result = frac::fit(data, structure, options);

  const std::string offset = options.offset ? io::format_number(*options.offset) : "free";
  const io::Metadata entries{{"weight", weight},
                             {"hold", hold == frac::Hold::zero_order ? "zero-order" : "first-order"},
                             {"offset", offset},
                             {"input-at-rest", io::format_number(at_rest)},
                             {"seed", request.seed}};
  CommandLine command("fit");
  command.argument(request.data).option("--model", model_text);
  for (const auto& [key, value] : entries) command.option("--" + key, value);
  for (const auto& text : parameters.bound) command.option("--bound", text);
  for (const auto& text : parameters.fix) command.option("--fix", text);
  for (const auto& text : parameters.start) command.option("--start", text);
  const FitRun run{command.text(), request.data, data.size(), data.time().front(), data.time().back(), "",
                   header,         entries,      true};
  const FitStatistics statistics = fit_statistics(data, options, result);
  const std::string format = chosen_format(common, "json");
  out.write(format == "json"  ? fit_json(run, result, statistics)
            : format == "csv" ? fit_csv(run, result, statistics)
                              : fit_table(run, result, statistics));
  if (result.termination == frac::FitTermination::converged) return usable_result;
  say(common, "no usable result: " + result.message);
  return no_usable_result;
}

}  // namespace fracfit
