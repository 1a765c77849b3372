// SPDX-License-Identifier: BSD-3-Clause
#include "fit_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "frac/identification/constraints.hpp"
#include "identification/data/first_order_whitening.hpp"

namespace frac {

Component fitted_component(const FrequencyResponseData& data, Component wanted) {
  const bool alone = wanted == Component::both && detail::is_empty(data, Component::real) &&
                     !detail::is_empty(data, Component::imaginary);
  return alone ? Component::imaginary : wanted;
}

}  // namespace frac

namespace frac::detail {

bool is_empty(const FrequencyResponseData& data, Component component) {
  if (component != Component::imaginary && component != Component::real) return false;
  return std::all_of(data.value().begin(), data.value().end(), [&](std::complex<double> value) {
    return (component == Component::real ? value.real() : value.imag()) == 0;
  });
}

FitOptions settled(const FitOptions& options, const FitResult& result) {
  FitOptions known = options;
  if (options.weight == Weight::learned && !options.noise_floor) known.noise_floor = result.noise_floor;
  return known;
}

TimeFitOptions settled(const TimeFitOptions& options, const FitResult& result) {
  TimeFitOptions known = options;
  for (const ParameterEstimate& each : result.parameters)
    if (each.name == offset_name && each.fixed) known.offset = each.value;
  if (std::exchange(known.noise, RecordNoise::white) == RecordNoise::coloured)
    known.noise_correlation = result.noise_correlation;
  return known;
}

void start_at(std::vector<ParameterConstraint>& constraints, const FitResult& result, bool over_time) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  for (const ParameterEstimate& estimate : result.parameters) {
    const bool eliminated = over_time && (estimate.name == offset_name || estimate.name == drift_name);
    if (eliminated || estimate.fixed || !std::isfinite(estimate.value)) continue;
    ParameterConstraint& known = constraint_of(constraints, estimate.name);
    if (!known.fixed)
      known.start = std::clamp(estimate.value, known.lower.value_or(-infinity), known.upper.value_or(infinity));
  }
}

std::vector<double> weighted_residuals(const FrequencyResponseData& data, const FitOptions& options,
                                       const FitResult& result) {
  return curve_residuals(data, residual_rule(data, settled(options, result)),
                         fitted_response(result, options.realisation, data.omega()));
}

std::vector<double> weighted_residuals(const TimeResponseData& data, const TimeFitOptions& options,
                                       const FitResult& result) {
  const std::vector<double> model = fitted_output(result, data, options);
  std::vector<double> residual;
  for (const std::size_t i : data.observed()) {
    residual.push_back((model[i] - data.output()[i]) / (data.sigma().empty() ? 1 : data.sigma()[i]));
  }
  FirstOrderWhitening(data.observed(), settled(options, result).noise_correlation).apply(residual);
  return residual;
}

std::vector<double> observed(const TimeResponseData& data, const std::vector<double>& values) {
  std::vector<double> result;
  for (const std::size_t i : data.observed()) result.push_back(values[i]);
  return result;
}

std::vector<double> weighted_output(const TimeResponseData& data) {
  std::vector<double> output;
  for (const std::size_t i : data.observed())
    output.push_back(data.output()[i] / (data.sigma().empty() ? 1 : data.sigma()[i]));
  return output;
}

FrequencyResponseData chosen_points(const FrequencyResponseData& data,
                                    const std::function<bool(std::size_t)>& is_chosen) {
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!is_chosen(i)) continue;
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    if (!data.sigma().empty()) sigma.push_back(data.sigma()[i]);
  }
  return {std::move(omega), std::move(value), std::move(sigma), data.frequency_unit()};
}

void hold(std::vector<ParameterConstraint>& constraints, std::string_view parameter, double value) {
  ParameterConstraint& own = constraint_of(constraints, parameter);
  const std::string above = own.above;
  own = {std::string(parameter), value, {}, {}, {}, {}, above};
}

}  // namespace frac::detail
