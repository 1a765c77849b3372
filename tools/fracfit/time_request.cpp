// SPDX-License-Identifier: BSD-3-Clause
#include "time_request.hpp"

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "choice.hpp"
#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/point_filter.hpp"
#include "io/time_series_file.hpp"

namespace fracfit {
namespace {

constexpr const char* offset_name = "offset";

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

std::string to_string(frac::Hold hold) {
  return hold == frac::Hold::zero_order ? "zero-order" : "first-order";
}

std::string offset_text(const frac::TimeFitOptions& options) {
  return options.offset ? io::format_number(*options.offset) : "free";
}

std::vector<io::SampleFilter> filters_of(const FitRequest& request) {
  std::vector<io::SampleFilter> filters;
  for (const auto& text : request.where) filters.emplace_back(text);
  return filters;
}

}  // namespace

void add_time_options(CLI::App& subcommand, TimeRequest& request) {
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

void refuse_time_options(const TimeRequest& request) {
  for (const auto& [name, text] : {std::pair{"--hold", &request.hold}, std::pair{"--offset", &request.offset},
                                   std::pair{"--input-at-rest", &request.input_at_rest}})
    if (!text->empty())
      throw std::invalid_argument(std::string(name) +
                                  " has no meaning with a frequency response, only with samples over time");
}

void refuse_frequency_options(const FitRequest& request) {
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
}

frac::TimeFitOptions time_fit_options(const FitRequest& request, const TimeRequest& over_time,
                                      std::vector<frac::ParameterConstraint> constraints) {
  frac::TimeFitOptions options;
  options.loss = frac::loss_from_string(request.loss);
  options.seed = seed_of(request);
  if (!over_time.offset.empty() && over_time.offset != "free")
    options.offset = number_option("--offset", over_time.offset);
  std::erase_if(constraints, [&](const frac::ParameterConstraint& constraint) {
    if (constraint.name != offset_name) return false;
    if (!constraint.fixed || constraint.lower || constraint.upper || constraint.start)
      throw std::invalid_argument(
          "the offset is either free or held (--fix offset=VALUE); it takes no --bound and no "
          "--start");
    if (!over_time.offset.empty()) throw std::invalid_argument("give either --offset or --fix offset=VALUE");
    options.offset = constraint.fixed;
    return true;
  });
  options.constraints = std::move(constraints);
  return options;
}

TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time, const CommonOptions& common) {
  const frac::Hold hold = hold_of(over_time.hold);
  const double at_rest =
      over_time.input_at_rest.empty() ? 0 : number_option("--input-at-rest", over_time.input_at_rest);
  io::TimeSeries series = io::read_time_response(request.data, filters_of(request));
  for (const auto& note : series.notes) say(common, request.data + ": " + note);
  const std::string weight = weight_of(request, series);
  if (weight == "absolute") series.sigma.clear();
  std::vector<std::size_t> index = std::move(series.kept);
  io::Metadata header = std::move(series.metadata);
  const frac::TimeResponseData data = io::time_response_data(request.data, std::move(series), hold, at_rest);
  if (index.empty()) throw io::DataError(request.data, 0, 0, "no sample satisfies --where");
  return {data.observed_at(std::move(index)), std::move(header), weight};
}

void append_to(CommandLine& command, const FitRequest& request, const TimeRecord& record,
               const frac::TimeFitOptions& options) {
  command.option("--weight", record.weight)
      .option("--loss", std::string(frac::to_string(options.loss)))
      .option("--hold", to_string(record.data.hold()))
      .option("--offset", offset_text(options))
      .option("--input-at-rest", io::format_number(record.data.input_at_rest()));
  for (const auto& test : request.where) command.option("--where", test);
  command.option("--seed", request.seed);
}

FitRun time_fit_run(const FitRequest& request, const TimeRecord& record, const frac::TimeFitOptions& options,
                    std::string command) {
  const auto& data = record.data;
  io::Metadata entries{{"weight", record.weight},
                       {"loss", std::string(frac::to_string(options.loss))},
                       {"hold", to_string(data.hold())},
                       {"offset", offset_text(options)},
                       {"input-at-rest", io::format_number(data.input_at_rest())},
                       {"seed", std::to_string(options.seed)}};
  std::string where;
  for (const auto& test : request.where) where += (where.empty() ? "" : " and ") + test;
  entries.emplace_back("where", where.empty() ? "all points" : where);
  return {std::move(command),
          request.data,
          data.observed().size(),
          data.time()[data.observed().front()],
          data.time()[data.observed().back()],
          "",
          record.header,
          std::move(entries),
          true};
}

}  // namespace fracfit
