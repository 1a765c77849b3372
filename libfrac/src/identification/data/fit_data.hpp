// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

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

/// The options with a start at the estimates of another fit, moved into the limits, and no search.  What a constraint
/// or that fit holds stays as the constraint says; an estimate that is not finite gives no start.
template <class Options>
[[nodiscard]] Options started_at(Options options, const FitResult& result);

/// Weighted residuals (model - data) of a result, points in order, each with as many as residuals_per_point(); over
/// time freed of the correlation of the noise that the options tell.
[[nodiscard]] std::vector<double> weighted_residuals(const FrequencyResponseData& data, const FitOptions& options,
                                                     const FitResult& result);
[[nodiscard]] std::vector<double> weighted_residuals(const TimeResponseData& data, const TimeFitOptions& options,
                                                     const FitResult& result);
[[nodiscard]] std::size_t residuals_per_point(const FrequencyResponseData& data, const FitOptions& options);
[[nodiscard]] inline std::size_t residuals_per_point(const TimeResponseData&, const TimeFitOptions&) {
  return 1;
}

[[nodiscard]] inline std::size_t points(const FrequencyResponseData& data) {
  return data.size();
}
[[nodiscard]] inline std::size_t points(const TimeResponseData& data) {
  return data.observed().size();
}

/// The points whose indices are chosen.
[[nodiscard]] FrequencyResponseData chosen_points(const FrequencyResponseData& data,
                                                  const std::function<bool(std::size_t)>& is_chosen);
/// The points [first, last), or all others.
[[nodiscard]] FrequencyResponseData part_of(const FrequencyResponseData& data, std::size_t first, std::size_t last,
                                            bool inside);
[[nodiscard]] TimeResponseData part_of(const TimeResponseData& data, std::size_t first, std::size_t last, bool inside);

/// Holds a parameter; nothing else that is known of it counts then, but which one it is above.
void hold(std::vector<ParameterConstraint>& constraints, std::string_view parameter, double value);
/// The fit with one parameter held.
void hold(FitOptions& options, std::string_view parameter, double value);
void hold(TimeFitOptions& options, std::string_view parameter, double value);

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
