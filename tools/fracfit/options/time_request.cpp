// SPDX-License-Identifier: BSD-3-Clause
#include "options/time_request.hpp"

#include <stdexcept>
#include <utility>

#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/point_filter.hpp"
#include "io/time_series_file.hpp"

namespace fracfit {
namespace {

constexpr const char* offset_name = "offset";

// "given" or "absolute".
std::string weight_of(const FitRequest& request, bool is_given, const io::TimeSeries& series) {
  if (!is_given) return series.sigma.empty() ? "absolute" : "given";
  if (request.weight == "absolute") return request.weight;
  if (request.weight != "given")
    throw std::invalid_argument("--weight " + io::quoted(request.weight) +
                                ": expected given or absolute with samples over time");
  if (series.sigma.empty())
    throw io::DataError(request.data, 0, 0, "has no column sigma; expected one with --weight given");
  return request.weight;
}

std::vector<io::SampleFilter> filters_of(const FitRequest& request) {
  std::vector<io::SampleFilter> filters;
  for (const auto& text : request.where) filters.emplace_back(text);
  return filters;
}

}  // namespace

void add_time_options(Options& options, TimeRequest& request) {
  options.choice("--hold", request.hold, frac::holds(), "of samples over time").only_for(samples_over_time);
  options
      .text("--offset", request.offset,
            "Samples over time: what the output shows at rest, free (estimated) or a number", "VALUE")
      .suggest({"free"})
      .only_for(samples_over_time);
  options
      .number("--input-at-rest", request.input_at_rest, "Samples over time: the input before the first sample", "VALUE")
      .only_for(samples_over_time);
  options.flag("--trend", request.trend, "Samples over time: estimate a steady drift of the output")
      .only_for(samples_over_time);
  options
      .flag("--earlier-input", request.earlier_input,
            "Samples over time: the record may start in motion; estimate levels of the input before it")
      .only_for(samples_over_time);
  options.choice("--noise", request.noise, frac::record_noises()).only_for(samples_over_time);
}

frac::TimeFitOptions time_fit_options(const FitRequest& request, const TimeRequest& over_time, Options& given,
                                      std::vector<frac::ParameterConstraint> constraints) {
  frac::TimeFitOptions options;
  options.loss = request.loss;
  options.seed = request.seed;
  options.trend = over_time.trend;
  options.earlier_input = over_time.earlier_input;
  options.noise = over_time.noise;
  const bool is_held = over_time.offset != "free";
  if (is_held) options.offset = number_of("--offset", over_time.offset);
  std::erase_if(constraints, [&](const frac::ParameterConstraint& constraint) {
    if (constraint.name != offset_name) return false;
    if (!constraint.fixed || constraint.lower || constraint.upper || constraint.start)
      throw std::invalid_argument(
          "the offset is either free or held (--fix offset=VALUE); it takes no --bound and no "
          "--start");
    if (is_held && *options.offset != *constraint.fixed)
      throw std::invalid_argument("give either --offset or --fix offset=VALUE");
    options.offset = constraint.fixed;
    given["--offset"].say(io::format_number(*constraint.fixed));
    return true;
  });
  options.constraints = std::move(constraints);
  return options;
}

TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time, bool weight_is_told,
                            const std::function<void(const std::string&)>& note) {
  io::TimeSeries series = io::read_time_response(request.data, filters_of(request));
  for (const auto& text : series.notes) note(request.data + ": " + text);
  const std::string weight = weight_of(request, weight_is_told, series);
  if (weight == "absolute") series.sigma.clear();
  std::vector<std::size_t> index = std::move(series.kept);
  io::Metadata header = std::move(series.metadata);
  const frac::TimeResponseData data =
      io::time_response_data(request.data, std::move(series), over_time.hold, over_time.input_at_rest);
  if (index.empty()) throw io::DataError(request.data, 0, 0, "no sample satisfies --where");
  return {data.observed_at(std::move(index)), std::move(header), weight};
}

TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time, Options& options,
                            const std::function<void(const std::string&)>& note) {
  TimeRecord record = read_time_record(request, over_time, options["--weight"].is_given(), note);
  options["--weight"].say(record.weight);
  return record;
}

FitRun time_fit_run(const FitRequest& request, const TimeRecord& record, const Options& options, std::string command) {
  const auto& data = record.data;
  auto entries = options.entries({"--weight", "--loss", "--hold", "--offset", "--input-at-rest", "--trend",
                                  "--earlier-input", "--noise", "--seed"});
  entries.emplace_back("where", where_text(request));
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
