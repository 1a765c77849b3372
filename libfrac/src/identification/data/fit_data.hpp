// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"
#include "residual_rule.hpp"

// Facts on data and options that profiles, bootstraps, rankings and cross-validation need, alike for both kinds.
namespace frac::detail {

/// Whether the data are a frequency response, rather than samples over time.
template <class Data>
inline constexpr bool is_response = std::is_same_v<Data, FrequencyResponseData>;
/// Options of fits to these data.
template <class Data>
using OptionsOf = std::conditional_t<is_response<Data>, FitOptions, TimeFitOptions>;

/// Name of the output at rest among the parameters of a fit over time.
inline constexpr const char* offset_name = "offset";
inline constexpr const char* drift_name = "drift";

/// Whether this component of the data, real or imaginary, is 0 at every frequency.
[[nodiscard]] bool is_empty(const FrequencyResponseData& data, Component component);

/// The options with what a fit has learned from the data: its noise floor, or that the offset is held.
[[nodiscard]] FitOptions settled(const FitOptions& options, const FitResult& result);
[[nodiscard]] TimeFitOptions settled(const TimeFitOptions& options, const FitResult& result);

/// Starts at the estimates of another fit, moved into the limits.  What a constraint or that fit holds stays as the
/// constraint says; an estimate that is not finite gives no start.
/// @param over_time  offset and drift are parameters of the fit, not of the structure
void start_at(std::vector<ParameterConstraint>& constraints, const FitResult& result, bool over_time);
/// The options with these starts, and no search.
template <class Options>
[[nodiscard]] Options started_at(Options options, const FitResult& result) {
  options.global_start = false;
  start_at(options.constraints, result, std::is_same_v<Options, TimeFitOptions>);
  return options;
}

/// Weighted residuals (model - data) of a result, points in order, each with as many as residuals_per_point(); over
/// time freed of the correlation of the noise that the options tell.
[[nodiscard]] std::vector<double> weighted_residuals(const FrequencyResponseData& data, const FitOptions& options,
                                                     const FitResult& result);
[[nodiscard]] std::vector<double> weighted_residuals(const TimeResponseData& data, const TimeFitOptions& options,
                                                     const FitResult& result);
template <class Data>
[[nodiscard]] std::size_t residuals_per_point(const Data&, const OptionsOf<Data>& options) {
  if constexpr (is_response<Data>)
    return residuals_per_point(residual_form(options.component, options.weight));
  else
    return 1;
}

/// Points, or outputs that count.
template <class Data>
[[nodiscard]] std::size_t points(const Data& data) {
  if constexpr (is_response<Data>)
    return data.size();
  else
    return data.observed().size();
}

/// Values at the samples whose outputs count.
[[nodiscard]] std::vector<double> observed(const TimeResponseData& data, const std::vector<double>& values);
/// Outputs that count over their sigma, or as they are where they have none.
[[nodiscard]] std::vector<double> weighted_output(const TimeResponseData& data);

/// The size of the weighted data that rounding is measured by: their rms, over time the largest.
template <class Data>
[[nodiscard]] double weighted_size(const Data& data, const OptionsOf<Data>& options) {
  if constexpr (is_response<Data>) {
    return residual_rule(data, options).unit;
  } else {
    double most = 0;
    for (const double each : weighted_output(data)) most = std::max(most, std::abs(each));
    return most;
  }
}

/// The points whose indices are chosen.
[[nodiscard]] FrequencyResponseData chosen_points(const FrequencyResponseData& data,
                                                  const std::function<bool(std::size_t)>& is_chosen);
/// The points [first, last), or all others; over time of the outputs that count.
template <class Data>
[[nodiscard]] Data part_of(const Data& data, std::size_t first, std::size_t last, bool inside) {
  const auto is_chosen = [&](std::size_t i) { return (i >= first && i < last) == inside; };
  if constexpr (is_response<Data>) {
    return chosen_points(data, is_chosen);
  } else {
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < data.observed().size(); ++i)
      if (is_chosen(i)) index.push_back(data.observed()[i]);
    return data.observed_at(std::move(index));
  }
}

/// Holds a parameter; nothing else that is known of it counts then, but which one it is above.
void hold(std::vector<ParameterConstraint>& constraints, std::string_view parameter, double value);
/// The fit with one parameter held.
template <class Options>
void hold(Options& options, std::string_view parameter, double value) {
  if constexpr (std::is_same_v<Options, TimeFitOptions>) {
    if (parameter == offset_name) {
      options.offset = value;
      return;
    }
  }
  hold(options.constraints, parameter, value);
}

/// Whether the correlation of the noise is to be estimated by a fit.
[[nodiscard]] inline bool noise_is_open(const TimeFitOptions& options) {
  return options.noise == RecordNoise::coloured && options.noise_correlation == 0;
}
/// The same options in noise of this correlation.
[[nodiscard]] inline TimeFitOptions in_noise(TimeFitOptions options, double correlation) {
  options.noise = RecordNoise::white;
  options.noise_correlation = correlation;
  return options;
}

}  // namespace frac::detail
