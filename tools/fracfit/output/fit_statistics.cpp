// SPDX-License-Identifier: BSD-3-Clause
#include "output/fit_statistics.hpp"

#include <cmath>
#include <limits>
#include <string_view>

#include "frac/parallel_for.hpp"
#include "io/number.hpp"
#include "io/output_file.hpp"
#include "io/result_stream.hpp"
#include "io/shard_file.hpp"
#include "output/document.hpp"

namespace fracfit {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::vector<double>> correlation_of(const std::vector<std::vector<double>>& covariance) {
  const std::size_t count = covariance.size();
  std::vector<std::vector<double>> correlation(count, std::vector<double>(count, nan));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      const double scale = std::sqrt(covariance[i][i]) * std::sqrt(covariance[j][j]);
      if (scale > 0) correlation[i][j] = i == j ? 1 : covariance[i][j] / scale;
    }
  }
  return correlation;
}

bool has_profile(const frac::ParameterEstimate& parameter, const frac::FitResult& result) {
  return !parameter.fixed && !parameter.from_other_component && std::isfinite(parameter.value) &&
         result.residuals > result.free_parameters;
}

const std::vector<double>& axis(const frac::FrequencyResponseData& data) {
  return data.omega();
}
const std::vector<double>& axis(const frac::TimeResponseData& data) {
  return data.time();
}

// The row of a refit, and the parameters in it.
std::string row_of(std::size_t sample, const std::vector<double>& parameters) {
  std::string row = std::to_string(sample);
  for (const double value : parameters) row += "," + io::format_number(value);
  return row + "\n";
}
std::vector<double> parameters_of(std::string_view row) {
  std::vector<double> parameters;
  row.remove_suffix(1);
  for (auto comma = row.find(','); comma != std::string_view::npos; comma = row.find(',')) {
    row.remove_prefix(comma + 1);
    parameters.push_back(io::parse_number(row.substr(0, row.find(','))).value());
  }
  return parameters;
}

// The fit stands in the head, so that the rows of other data are not taken for these.
std::string head_of(const frac::FitResult& result, const StatisticsRequest& request) {
  Document document{{{"model", result.model}}, {{"sample"}, 0, {}}};
  for (const auto& parameter : result.parameters) {
    document.head.emplace_back("fitted_" + parameter.name, io::format_number(parameter.value));
    document.rows.columns.push_back(parameter.name);
  }
  return csv_head(document, request.command);
}

std::vector<std::vector<double>> refits_on_disk(const frac::BootstrapRefits& refits, const frac::FitResult& result,
                                                const StatisticsRequest& request, int threads) {
  const io::OutputFile file(request.refits_file);
  const std::string head = head_of(result, request);
  io::ResultStream stream(request.refits_file + ".partial", std::string(io::unfinished_line) + "\n" + head);
  std::vector<std::vector<double>> values(request.bootstrap_samples);
  frac::parallel_for(values.size(), threads, [&](std::size_t sample) {
    const std::string key = std::to_string(sample);
    if (!stream.contains(key)) stream.append(key, row_of(sample, refits.parameters(sample)));
    values[sample] = parameters_of(stream.text(key));
  });
  file.write([&](const io::OutputFile::Sink& sink) {
    sink(head);
    for (std::size_t sample = 0; sample < values.size(); ++sample) sink(stream.text(std::to_string(sample)));
  });
  stream.remove();
  return values;
}

template <class Data, class Options>
FitStatistics statistics_of(const Data& data, const Options& options, const frac::FitResult& result,
                            const StatisticsRequest& request, int threads) {
  FitStatistics statistics;
  statistics.correlation = correlation_of(result.covariance);
  for (const std::size_t index : result.outliers) statistics.outlier_at.push_back(axis(data)[index]);
  if (result.termination == frac::FitTermination::no_usable_start) {
    statistics.whiteness = {nan, nan};
    statistics.lack_of_fit = {frac::NoiseSource::data, nan, nan, nan, nan, nan, false, {}};
    return statistics;
  }
  statistics.whiteness = frac::residual_whiteness(data, options, result);
  statistics.lack_of_fit = frac::lack_of_fit(data, options, result);
  if (request.profile) {
    statistics.profile.resize(result.parameters.size());
    frac::parallel_for(result.parameters.size(), threads, [&](std::size_t i) {
      if (has_profile(result.parameters[i], result))
        statistics.profile[i] = frac::profile_interval(data, options, result, result.parameters[i].name);
    });
  }
  statistics.bootstrap_samples = request.bootstrap_samples;
  if (request.bootstrap_samples == 0) return statistics;
  if (request.refits_file.empty())
    statistics.bootstrap = frac::bootstrap(data, options, result, request.bootstrap_samples, threads);
  else
    statistics.bootstrap = frac::bootstrap_intervals(
        refits_on_disk(frac::BootstrapRefits(data, options, result), result, request, threads));
  return statistics;
}

}  // namespace

FitStatistics fit_statistics(const frac::FrequencyResponseData& data, const frac::FitOptions& options,
                             const frac::FitResult& result, const StatisticsRequest& request, int threads) {
  return statistics_of(data, options, result, request, threads);
}

FitStatistics fit_statistics(const frac::TimeResponseData& data, const frac::TimeFitOptions& options,
                             const frac::FitResult& result, const StatisticsRequest& request, int threads) {
  return statistics_of(data, options, result, request, threads);
}

}  // namespace fracfit
