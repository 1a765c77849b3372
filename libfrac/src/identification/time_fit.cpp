// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/time_fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "base/number_text.hpp"
#include "frac/identification/model_choice.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/search/robust.hpp"
#include "identification/search/time_search.hpp"
#include "identification/statistics/confidence.hpp"
#include "identification/statistics/estimates.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using detail::offset_name;

double length_of(const TimeResponseData& data) {
  return data.time().back() - data.time().front();
}

double root_mean_square(const std::vector<double>& values, double base) {
  double sum = 0;
  for (const double value : values) sum += (value - base) * (value - base);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

std::vector<double> observed_output(const TimeResponseData& data) {
  std::vector<double> output;
  for (const std::size_t i : data.observed()) output.push_back(data.output()[i]);
  return output;
}

// Gains about what the spread of the output is to the input, frequencies from a third of the record's inverse to three
// times the sampling rate.
detail::DataScale data_scale(const TimeResponseData& data, std::optional<double> offset) {
  const std::vector<double> output = observed_output(data);
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

// A dead time beyond the record would leave nothing to fit.
std::vector<ParameterConstraint> with_delay_limits(const Structure& structure,
                                                   std::vector<ParameterConstraint> constraints, double length) {
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] != ParameterRole::delay) continue;
    const std::string& name = structure.parameter_names()[i];
    const auto given = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    if (given == constraints.end()) {
      constraints.push_back({name, {}, {}, length, {}});
    } else if (!given->fixed && !given->upper) {
      given->upper = std::max(length, 2 * given->start.value_or(0));
    }
  }
  return constraints;
}

void check(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
           const detail::ParameterMap& map) {
  for (const std::string& name : structure.parameter_names()) {
    if (name == offset_name) {
      throw std::invalid_argument(
          "parameter 'offset': the name stands for the output at rest; rename it in the formula");
    }
  }
  if (options.offset && !std::isfinite(*options.offset)) {
    throw std::invalid_argument("offset = " + std::to_string(*options.offset) + "; allowed is a finite number");
  }
  // Whether it reduces does not depend on the values; those of a start may be missing.
  std::vector<double> values;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const bool is_order = structure.parameter_roles()[i] == ParameterRole::order;
    const double known = map.start()[i];
    values.push_back(std::isnan(known) ? (is_order ? 0.7 + 0.01 * static_cast<double>(i) : 0.5) : known);
  }
  static_cast<void>(detail::reduce(structure.expression(), values, detail::Sensitivity::all));
  const std::size_t free = map.free().size() + (options.offset ? 0 : 1);
  if (data.observed().size() < free) {
    throw std::invalid_argument(std::to_string(data.observed().size()) + " samples cannot determine " +
                                std::to_string(free) + " free parameters" +
                                (options.offset ? "" : ", the offset among them"));
  }
}

// Standard deviation of the weighted output: the unit of the residuals the solvers see.
double unit_of(const TimeResponseData& data, std::optional<double> offset) {
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

// That of the offset by correlated noise: it takes the weighted mean of the noise, less what the parameters take of it.
double offset_widening(const detail::TimeResiduals& residuals, const detail::Confidence& found,
                       const Eigen::VectorXd& mean_gradient) {
  const Eigen::VectorXd weight = residuals.eliminated_columns().col(0);
  Eigen::VectorXd influence = weight / weight.squaredNorm();
  if (found.influence.size() > 0) influence -= found.influence * mean_gradient;
  return found.noise.widening(influence);
}

// The offset as one more parameter: the mean of what the model leaves, with the spread of that mean and, through the
// model, that of the parameters.
void append_offset(FitResult& result, const detail::TimeResiduals& residuals, const std::vector<double>& theta,
                   const TimeResponseData& data, const detail::Confidence& found, double unit) {
  const auto [value, mean_gradient] = residuals.offset(theta);
  double information = 0;
  for (const std::size_t i : data.observed()) {
    information += data.sigma().empty() ? 1 : 1 / (data.sigma()[i] * data.sigma()[i]);
  }
  const std::size_t count = result.covariance.size();
  std::vector<double> covariance(count + 1, 0.0);
  double variance = std::pow(found.deviation * unit, 2) / information;
  const double widening = offset_widening(residuals, found, mean_gradient);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      const double both = result.covariance[i][j];
      if (std::isnan(both)) continue;
      covariance[i] -= mean_gradient[static_cast<Eigen::Index>(j)] * both / found.widening[j] * widening;
      variance += mean_gradient[static_cast<Eigen::Index>(i)] * mean_gradient[static_cast<Eigen::Index>(j)] * both /
                  (found.widening[i] * found.widening[j]);
    }
    if (std::isnan(result.covariance[i][i])) covariance[i] = nan;
  }
  variance *= widening * widening;
  covariance[count] = variance;
  for (std::size_t i = 0; i < count; ++i) result.covariance[i].push_back(covariance[i]);
  result.covariance.push_back(covariance);
  const double error = std::sqrt(variance);
  // An offset of nothing is known as well as any: what counts is its interval beside what the output does.
  const std::vector<double> output = observed_output(data);
  const auto [least, largest] = std::minmax_element(output.begin(), output.end());
  const bool narrow = !(2 * found.t * error > *largest - *least);
  const bool alone = std::find(found.seen.begin(), found.seen.end(), false) == found.seen.end();
  result.parameters.push_back({offset_name, value, error, value - found.t * error, value + found.t * error, false,
                               false, narrow && alone, value, error, false});
  result.parameters.back().widening = widening;
}

// Where no response to the input can be told from noise, no parameter of one can.
void refuse_unseen_response(FitResult& result, const detail::TimeResiduals& residuals,
                            const detail::LocalOptions& local, std::size_t rank, double unit) {
  const std::size_t eliminated = residuals.eliminated();
  if (rank == 0 || result.residuals <= rank + eliminated) return;
  const std::vector<double> silent = residuals.without_response();
  FitResult with = result, without = result;
  with.cost = result.loss_cost;
  with.free_parameters = rank + eliminated;
  without.cost = detail::loss_cost(silent, 1, local) * unit * unit;
  without.free_parameters = eliminated;
  const FTest test = f_test(without, with);
  if (test.p_value < 0.01) return;
  for (ParameterEstimate& estimate : result.parameters) {
    if (estimate.name != offset_name && !estimate.fixed) estimate.identified = false;
  }
  char text[160];
  std::snprintf(text, sizeof text,
                " Without any response to the input the output is explained as well (F test, p = %.2g): nothing of the "
                "model is identified.",
                test.p_value);
  result.message += text;
}

// Why there is nothing to fit, if so.
std::string explained_by_offset(const TimeResponseData& data, std::optional<double> offset) {
  const std::vector<double> output = observed_output(data);
  const double rest = offset.value_or(output.front());
  if (std::any_of(output.begin(), output.end(), [&](double value) { return value != rest; })) return {};
  return "The output is " + detail::number_text(rest) +
         " throughout: its offset alone explains it, and a response to the input is not identifiable.";
}

// Why no parameter changes the output at the instants that count, if so.
std::string unseen_model(const Structure& structure, const detail::ParameterMap& map, const TimeResponseData& data,
                         const detail::Confidence& found, const std::vector<double>& theta) {
  if (map.free().empty()) return {};
  const double length = data.time()[data.observed().back()] - data.time().front();
  const double delay = detail::reduce(structure.expression(), map.to_user(theta)).delay;
  if (delay >= length) {
    return "The dead time of the model is " + detail::number_text(delay) + " s, no less than the record of " +
           detail::number_text(length) + " s: nothing of the input reaches the output.";
  }
  const bool seen =
      std::any_of(map.free().begin(), map.free().end(), [&](const auto& entry) { return found.seen[entry.parameter]; });
  return seen ? "" : "No parameter of the model changes the output within the record: none is identifiable.";
}

std::string ending(const detail::GlobalSolution& solution, bool is_exact) {
  if (!solution.best.converged) return "The solver stopped before the cost settled; the best point found is returned.";
  const std::string solves =
      std::to_string(solution.starts) + (solution.starts == 1 ? " solve" : " solves") + " in all.";
  if (is_exact) return "The model meets every sample to rounding; " + solves;
  return std::to_string(solution.starts_at_best) + (solution.starts_at_best == 1 ? " start" : " starts") +
         " ended at the lowest cost; " + solves;
}

}  // namespace

FitResult fit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const detail::ParameterMap map(structure, with_delay_limits(structure, options.constraints, length_of(data)),
                                 data_scale(data, options.offset));
  check(data, structure, options, map);
  if (!options.global_start && !is_complete(map.start(), map)) {
    for (const auto& entry : map.free()) {
      if (!std::isnan(map.start()[entry.parameter])) continue;
      throw std::invalid_argument("parameter '" + structure.parameter_names()[entry.parameter] +
                                  "' has no start value, and the search for one is switched off");
    }
  }
  const double unit = unit_of(data, options.offset);
  const detail::TimeProblem problem{data, structure, map, options, unit};
  const std::string silence = explained_by_offset(data, options.offset);
  const detail::GlobalSolution solution = silence.empty() ? time_search(problem) : detail::GlobalSolution{};
  detail::LocalSolution best = solution.best;
  detail::TimeResiduals residuals = problem.residuals(data.observed(), detail::finest_simulation);
  FitResult result = describe_search(structure, residuals, solution);
  result.distinct_minima = 1;
  result.confidence_of_optimum = nan;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (solution.starts_at_best == 0) {
    describe_failure(
        result, structure, map,
        silence.empty() ? "The model has no finite response to this input anywhere it was tried." : silence);
    result.seconds = seconds();
    return result;
  }

  detail::LocalOptions local;
  if (options.loss != Loss::none) {
    const auto scale = options.loss_scale ? std::optional(*options.loss_scale / unit) : std::nullopt;
    local = robust_refinement(residuals, options.loss, scale, best);
  }
  const detail::Confidence found = confidence(residuals, best, local);
  result.message = ending(solution, best.cost <= residuals.rounding_cost());
  const std::string unseen = unseen_model(structure, map, data, found, best.theta);
  if (!unseen.empty()) {
    describe_failure(result, structure, map, unseen);
    result.seconds = seconds();
    return result;
  }
  describe_estimates(result, structure, residuals, options.constraints, found, best.theta);
  describe_residuals(result, residuals, local, found, best.theta, unit);
  for (std::size_t& point : result.outliers) point = data.observed()[point];
  if (!options.offset) append_offset(result, residuals, best.theta, data, found, unit);
  refuse_unseen_response(result, residuals, local, found.rank, unit);
  result.termination = best.converged ? FitTermination::converged : FitTermination::not_converged;
  result.seconds = seconds();
  return result;
}

std::vector<double> fitted_output(const FitResult& result, const TimeResponseData& data,
                                  const TimeFitOptions& options) {
  const Structure structure(result.model);
  std::vector<double> parameters;
  double offset = options.offset.value_or(0);
  for (const ParameterEstimate& estimate : result.parameters) {
    if (estimate.name == offset_name) {
      offset = estimate.value;
    } else {
      parameters.push_back(estimate.value);
    }
  }
  std::vector<double> output(data.size(), nan);
  std::vector<std::size_t> all(data.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto events = detail::event_response(data, all);
  detail::EventResponse::Result model;
  if (!events.evaluate(detail::reduce(structure.expression(), parameters), detail::finest_simulation, model))
    return output;
  for (std::size_t i = 0; i < output.size(); ++i) output[i] = model.value[static_cast<Eigen::Index>(i)] + offset;
  return output;
}

}  // namespace frac
