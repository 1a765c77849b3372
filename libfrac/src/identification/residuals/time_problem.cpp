// SPDX-License-Identifier: BSD-3-Clause
#include "time_problem.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "identification/data/fit_data.hpp"

namespace frac::detail {
namespace {

double root_mean_square(const std::vector<double>& values, double base) {
  double sum = 0;
  for (const double value : values) sum += (value - base) * (value - base);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Gains about what the spread of the output is to the input, frequencies from a third of the record's inverse to three
/// times the sampling rate.
DataScale data_scale(const TimeResponseData& data, std::optional<double> offset) {
  const std::vector<double> output = observed(data, data.output());
  const double mean = std::accumulate(output.begin(), output.end(), 0.0) / static_cast<double>(output.size());
  const double spread = root_mean_square(output, offset.value_or(mean));
  const double gain = spread > 0 ? spread / root_mean_square(data.input(), data.input_at_rest()) : 1;
  constexpr double margin = 3;
  const double slow = 1 / length_of(data);
  double shortest_step = length_of(data);
  for (std::size_t i = 1; i < data.size(); ++i) {
    shortest_step = std::min(shortest_step, data.time()[i] - data.time()[i - 1]);
  }
  const double fast = 1 / shortest_step;
  return {gain, gain / 30, gain * 30, std::sqrt(slow * fast), slow / margin, fast * margin};
}

Background background_of(const TimeFitOptions& options) {
  return {options.offset, options.trend, options.earlier_input, options.noise_correlation};
}

}  // namespace

double output_deviation(const TimeResponseData& data, std::optional<double> offset) {
  double weights = 0, mean = 0;
  const auto weight = [&](std::size_t i) { return data.sigma().empty() ? 1 : 1 / data.sigma()[i]; };
  for (const std::size_t i : data.observed()) {
    weights += weight(i) * weight(i);
    mean += weight(i) * weight(i) * data.output()[i];
  }
  mean = offset.value_or(mean / weights);
  double sum = 0;
  for (const std::size_t i : data.observed()) sum += std::pow(weight(i) * (data.output()[i] - mean), 2);
  const double unit = std::sqrt(sum / static_cast<double>(data.observed().size()));
  return unit > 0 ? unit : 1;
}

double length_of(const TimeResponseData& data) {
  return data.time().back() - data.time().front();
}

TimeProblem::TimeProblem(const TimeResponseData& given, const Structure& model, const TimeFitOptions& wanted)
    : Problem(model, with_longest_delay(model, wanted.constraints, length_of(given)), data_scale(given, wanted.offset),
              false),
      data(given),
      options(wanted),
      periodic_(periodic_input(given)) {
  unit = output_deviation(given, wanted.offset);
}

TimeProblem::TimeProblem(const TimeResponseData& given, const Structure& model, const TimeFitOptions& wanted,
                         ByParameters by)
    : Problem(model, by), data(given), options(wanted), periodic_(periodic_input(given)) {
  unit = output_deviation(given, wanted.offset);
}

TimeProblem::TimeProblem(const TimeProblem& like, TimeFitOptions known, std::vector<ParameterConstraint> of_parameters)
    : Problem(like.structure, std::move(of_parameters), like.map.scale(), false),
      data(like.data),
      options(std::move(known)),
      periodic_(like.periodic_) {
  unit = like.unit;
}

TimeResiduals& TimeProblem::residuals() {
  if (!residuals_)
    residuals_.emplace(data, structure, map, background_of(options), data.observed(), finest_simulation, unit, priors,
                       periodic_);
  return *residuals_;
}

TimeResiduals TimeProblem::residuals_at(std::vector<std::size_t> index, double tolerance) const {
  return {data, structure, map, background_of(options), std::move(index), tolerance, unit, priors, periodic_};
}

std::unique_ptr<TimeProblem> TimeProblem::with_offset(double offset) const {
  TimeFitOptions known = options;
  known.offset = offset;
  return std::unique_ptr<TimeProblem>(new TimeProblem(*this, std::move(known), constraints));
}

std::unique_ptr<Problem> TimeProblem::held(std::string_view parameter, double value) const {
  if (parameter == offset_name) return with_offset(value);
  std::vector<ParameterConstraint> known = constraints;
  hold(known, parameter, value);
  return std::unique_ptr<Problem>(new TimeProblem(*this, options, std::move(known)));
}

}  // namespace frac::detail
