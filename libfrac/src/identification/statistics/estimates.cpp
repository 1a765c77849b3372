// SPDX-License-Identifier: BSD-3-Clause
#include "estimates.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "identification/search/interchange.hpp"
#include "identification/search/robust.hpp"
#include "information.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Of two like parts the data may tell the sum alone: what one has the other lacks, as their correlation shows.  Then
/// neither is identified, also where the interval of one is narrow.
void refuse_inseparable_parts(FitResult& result, const Structure& structure) {
  constexpr double inseparable = 0.98;  // correlation
  for (const Interchange& parts : interchanges(structure)) {
    for (const auto& [a, b] : parts.pairs) {
      ParameterEstimate &first = result.parameters[a], &second = result.parameters[b];
      if (first.identified == second.identified || first.fixed || second.fixed) continue;
      const double correlation = result.covariance[a][b] / (first.standard_error * second.standard_error);
      if (std::abs(correlation) > inseparable) first.identified = second.identified = false;
    }
  }
}

/// Orders of parameters that are in force.
std::string remark_on_orders(const FitResult& result, std::span<const ParameterConstraint> constraints) {
  std::vector<std::string> in_force;
  for (const ParameterConstraint& constraint : constraints) {
    for (const ParameterEstimate& each : result.parameters)
      if (!constraint.above.empty() && each.name == constraint.name && each.at_bound)
        in_force.push_back(constraint.above + " < " + each.name);
  }
  if (in_force.empty()) return {};
  return " The order " + listed(in_force) +
         " is in force: the data want it the other way round, and intervals take the two as equal.";
}

/// The constraint of a parameter; empty where there is none.
const ParameterConstraint* constraint_on(const std::string& name, std::span<const ParameterConstraint> constraints) {
  const auto found = std::find_if(constraints.begin(), constraints.end(),
                                  [&](const ParameterConstraint& each) { return each.name == name; });
  return found == constraints.end() ? nullptr : &*found;
}

/// Whether an entry that ended at a bound did so at a limit that nobody has given, and that other data may pass.
bool ended_at_default(const ParameterMap::Free& entry, double theta, const ParameterConstraint* given) {
  const bool at_lower = theta - entry.lower < entry.upper - theta;
  if (!std::isfinite(at_lower ? entry.least : entry.most)) return false;
  if (given == nullptr) return true;
  return given->above.empty() && !given->positive && !(at_lower ? given->lower : given->upper).has_value();
}

/// What limits say about the result: parameters that ended at one, and residuals as many as parameters.
void remark_on_limits(FitResult& result, const ParameterMap& map, std::span<const double> theta,
                      std::span<const ParameterConstraint> constraints, bool degrees_left) {
  std::vector<std::string> at_bound, ranges;
  Advice advice{Remedy::give_limits};
  for (std::size_t k = 0; k < map.free().size(); ++k) {
    const ParameterMap::Free& entry = map.free()[k];
    const ParameterEstimate& estimate = result.parameters[entry.parameter];
    if (!estimate.at_bound) continue;
    at_bound.push_back(estimate.name);
    if (!ended_at_default(entry, theta[k], constraint_on(estimate.name, constraints))) continue;
    advice.parameters.push_back(estimate.name);
    const bool is_coefficient = entry.role == ParameterRole::coefficient;
    ranges.push_back(estimate.name + (is_coefficient ? " is taken as positive"
                                                     : " is taken from " + four_digits(estimate.lower_limit) + " to " +
                                                           four_digits(estimate.upper_limit)));
  }
  if (!at_bound.empty())
    result.message += " At a bound: " + listed(at_bound) + "." + remark_on_orders(result, constraints);
  if (!ranges.empty()) {
    result.message += " Unless other limits are given, " + listed(ranges) + ".";
    result.advice.push_back(std::move(advice));
  }
  if (!degrees_left) {
    result.message += " The residuals are no more than the parameters, so there are no intervals.";
  }
}

/// What the correlation of neighbouring residuals has done to the intervals, where there is any to speak of.
std::string remark_on_correlation(const FitResult& result, const Confidence& found, double cost, double rounding_cost) {
  // Four to one, where it is two to one beforehand: said of 2 of 300 fits in white noise.
  constexpr double told = 0.8;
  if (result.without_noise || !(found.noise.chance() > told) || !(cost > rounding_cost)) return {};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const ParameterEstimate& estimate : result.parameters) {
    if (!std::isfinite(estimate.ci95_lower)) continue;
    least = std::min(least, estimate.widening);
    most = std::max(most, estimate.widening);
  }
  if (!(most > 0)) return {};
  const auto two_digits = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return std::string(text);
  };
  const std::string from = two_digits(least), to = two_digits(most);
  std::string text;
  if (found.noise.smooth_chance() > 0.5 * found.noise.chance()) {
    text = " The residuals go smoothly along the axis, by an error of the data or of the model";
  } else {
    char correlation[64];
    std::snprintf(correlation, sizeof correlation, " Neighbouring residuals go together (correlation %.2f)",
                  found.noise.correlation());
    text = correlation + std::string(", by the noise or by what the model lacks");
  }
  return text + ": intervals are " + (from == to ? from : from + " to " + to) +
         " times as wide as white noise would make them.";
}

void describe_priors(FitResult& result, const Residuals& residuals) {
  if (!residuals.priors()) return;
  for (const Priors::Entry& entry : residuals.priors()->entries()) {
    const ParameterEstimate& estimate = result.parameters[entry.parameter];
    result.priors.push_back(prior_estimate(estimate.name, entry.prior, estimate));
  }
  result.message += remark_on_priors(result.priors);
}

}  // namespace

PriorEstimate prior_estimate(const std::string& name, const ParameterPrior& prior, const ParameterEstimate& estimate) {
  PriorEstimate found{name, prior, prior.distance(estimate.value), nan, nan};
  if (!std::isfinite(estimate.standard_error)) return found;
  // In units of the prior's variance.  White noise and the prior weigh against each other: of a posterior of variance w
  // what lies beside the prior has w/(1 - w) in white noise, so that its distance from the prior's value is
  // distance/(1 - w).  Correlated noise adds to the variance of the estimate, of which it is the part (1 - w)^2.
  const double error = estimate.standard_error * prior.slope(estimate.value);
  const double white = error / estimate.widening, added = error * error - white * white;
  found.share = std::min(1.0, white * white);
  const double data = 1 - found.share;
  constexpr double nothing_else = 1e-6;
  if (data > nothing_else) found.conflict = found.distance / std::sqrt(data + added);
  return found;
}

std::string remark_on_priors(std::span<const PriorEstimate> priors) {
  constexpr double contradiction = 2.576;  // once in 100 where both are right
  constexpr double mainly = 0.9;
  std::string text;
  char more[200];
  std::vector<std::string> told;
  for (const PriorEstimate& each : priors) {
    if (each.share > mainly) told.push_back(each.name);
    if (!(std::abs(each.conflict) > contradiction)) continue;
    std::snprintf(more, sizeof more, " The data contradict the prior of %s by %.1f standard deviations.",
                  each.name.c_str(), std::abs(each.conflict));
    text += more;
  }
  if (!told.empty()) text += " What is said of " + listed(told) + " is little more than the prior.";
  return text;
}

FitResult describe_search(const Structure& structure, const Residuals& residuals, const GlobalSolution& solution) {
  FitResult result{};
  result.model = structure.formula();
  result.residuals = residuals.count();
  result.free_parameters = residuals.map().free().size() + residuals.eliminated();
  result.starts = solution.starts;
  result.starts_at_best = solution.starts_at_best;
  result.distinct_minima = solution.minima;
  result.confidence_of_optimum = solution.confidence;
  result.centre_omega = residuals.map().scale().omega;
  return result;
}

void describe_failure(FitResult& result, const Structure& structure, const ParameterMap& map, std::string message) {
  result.cost = result.rms = result.max_residual = result.aicc = result.bic = result.condition = nan;
  result.noise_correlation = result.smooth_error = nan;
  result.loss_cost = result.loss_scale = result.loss_unit = nan;
  result.termination = FitTermination::no_usable_start;
  result.message = std::move(message);
  for (std::size_t i = 0; i < map.parameter_count(); ++i) {
    result.parameters.push_back(
        {structure.parameter_names()[i], nan, nan, nan, nan, map.is_fixed(i), false, false, nan, nan, false});
  }
}

void describe_estimates(FitResult& result, const Structure& structure, const Residuals& residuals,
                        std::span<const ParameterConstraint> constraints, const Confidence& found,
                        std::span<const double> theta) {
  const ParameterMap& map = residuals.map();
  const std::vector<double> values = map.to_user(theta);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double widening = found.widening[i];
    const double half_width = found.t * widening * found.standard_error[i];
    ParameterEstimate estimate{};
    estimate.name = structure.parameter_names()[i];
    estimate.value = estimate.centre_value = values[i];
    estimate.fixed = map.is_fixed(i);
    estimate.standard_error = estimate.fixed ? 0 : widening * found.standard_error[i];
    estimate.centre_standard_error = estimate.fixed ? 0 : widening * found.centre_standard_error[i];
    estimate.widening = widening;
    estimate.ci95_lower = estimate.fixed ? nan : values[i] - half_width;
    estimate.ci95_upper = estimate.fixed ? nan : values[i] + half_width;
    estimate.at_bound = found.at_bound[i];
    estimate.identified = found.identified[i] && !found.at_bound[i];
    if (estimate.fixed) estimate.lower_limit = estimate.upper_limit = values[i];
    result.parameters.push_back(std::move(estimate));
  }
  for (std::size_t k = 0; k < map.free().size(); ++k) {
    const ParameterMap::Free& entry = map.free()[k];
    ParameterEstimate& estimate = result.parameters[entry.parameter];
    estimate.centre_value = map.centre_value(k, values);
    estimate.lower_limit = entry.least;
    estimate.upper_limit = entry.most;
    const ParameterConstraint* const given = constraint_on(estimate.name, constraints);
    estimate.limits_given = given != nullptr && (given->lower || given->upper || given->positive);
  }
  result.covariance = found.covariance;
  result.noise_correlation = found.noise.correlation();
  refuse_inseparable_parts(result, structure);
  constexpr double met = 1e-9;
  result.without_noise |= result.free_parameters < result.residuals &&
                          residuals.cost(theta) <= met * met * static_cast<double>(result.residuals);
  result.condition = found.condition;
  result.effective_parameters = found.effective() + static_cast<double>(residuals.eliminated());
  describe_priors(result, residuals);
  if (found.condition > flat_condition) {
    char text[128];
    std::snprintf(text, sizeof text,
                  " The scaled Fisher condition is %.1e, beyond %.0e: some parameters only trade off.", found.condition,
                  flat_condition);
    result.message += text;
  }
  result.message += remark_on_correlation(result, found, residuals.cost(theta), residuals.rounding_cost());
  remark_on_limits(result, map, theta, constraints, residuals.count() > map.free().size() + residuals.eliminated());
}

void describe_residuals(FitResult& result, const Residuals& residuals, const LocalOptions& options,
                        const Confidence& found, std::span<const double> theta, double unit) {
  std::vector<double> residual = residuals_at(residuals, theta);
  result.outliers = outliers(residual, residuals.per_point());
  result.loss_cost = loss_cost(residual, residuals.per_point(), options) * unit * unit;
  result.loss_scale = options.loss == Loss::none ? nan : options.loss_scale * unit;
  result.loss_unit = found.loss_unit * unit * unit;
  result.smooth_error = found.noise.smooth_error() * unit;
  for (double& value : residual) value *= unit;
  const Information information =
      detail::information(residual, found.effective() + static_cast<double>(residuals.eliminated()), unit);
  result.cost = information.cost;
  result.rms = information.rms;
  result.relative_rms = information.rms / unit;
  result.max_residual = information.max_residual;
  result.aicc = information.aicc;
  result.bic = information.bic;
}

}  // namespace frac::detail
