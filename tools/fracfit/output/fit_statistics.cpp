// SPDX-License-Identifier: BSD-3-Clause
#include "output/fit_statistics.hpp"

#include <cmath>
#include <limits>

#include "frac/parallel_for.hpp"

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
  if (request.bootstrap_samples > 0)
    statistics.bootstrap = frac::bootstrap(data, options, result, request.bootstrap_samples, threads);
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
