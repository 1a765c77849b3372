// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "curves_alone.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/formula_checks.hpp"
#include "joint_confidence.hpp"
#include "noise_levels.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Alone = std::vector<std::optional<FitResult>>;

/// Standard deviation of a residual of each curve.
std::vector<double> noise_of(const std::vector<JointCurve>& curves, const std::vector<detail::ResidualRule>& rules,
                             const Alone& alone, Weight weight) {
  std::vector<double> noise(curves.size(), 1.0);
  if (weight == Weight::given || weight == Weight::repeats) return noise;
  std::vector<detail::CurveVariance> told(curves.size(), {0, 0});
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (!alone[c]) continue;
    const double degrees = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    // An exact fit leaves rounding, of which no less than this is meant.
    const double rounding = 1e-14 * rules[c].unit;
    if (degrees > 0) told[c] = {std::max(alone[c]->cost / degrees, rounding * rounding), degrees};
  }
  const std::vector<double> variance = detail::moderated_variances(told);
  std::transform(variance.begin(), variance.end(), noise.begin(), [](double each) { return std::sqrt(each); });
  return noise;
}

/// Values of every variable in the fits alone, one list per curve that has one; the user's starts where none has.
struct StartValues {
  std::vector<std::vector<double>> parameters;  // of each curve
  std::vector<bool> from_curve;
};

StartValues start_values(const Structure& structure, const JointFitOptions& options, const Alone& alone) {
  std::vector<double> otherwise;
  const auto best = std::min_element(alone.begin(), alone.end(), [](const auto& a, const auto& b) {
    return a.has_value() && (!b.has_value() || a->rms < b->rms);
  });
  if (best->has_value()) {
    for (const ParameterEstimate& each : (*best)->parameters) otherwise.push_back(each.value);
  } else {
    for (const std::string& name : structure.parameter_names()) {
      const auto known = std::find_if(options.fit.constraints.begin(), options.fit.constraints.end(),
                                      [&](const ParameterConstraint& each) { return each.name == name; });
      if (known == options.fit.constraints.end() || !(known->start || known->fixed))
        throw std::invalid_argument("no curve alone determines all parameters of " + structure.formula() +
                                    "; give a start value for '" + name + "'");
      otherwise.push_back(known->start ? *known->start : *known->fixed);
    }
  }
  StartValues result;
  for (const auto& fit : alone) {
    result.from_curve.push_back(fit.has_value());
    std::vector<double>& values = result.parameters.emplace_back(otherwise);
    for (std::size_t i = 0; fit && i < values.size(); ++i) values[i] = fit->parameters[i].value;
  }
  return result;
}

/// Constraints on parameters of the laws, which the fits of single curves do not know.
std::vector<ParameterConstraint> taken_out(std::vector<ParameterConstraint>& constraints, const detail::Laws& laws) {
  std::vector<ParameterConstraint> of_laws;
  for (const ParameterConstraint& each : constraints) {
    if (!laws.has(each.name)) continue;
    if (each.fixed)
      throw std::invalid_argument("parameter '" + each.name + "' of a law is fixed; write the number into the law");
    of_laws.push_back(each);
  }
  std::erase_if(constraints, [&](const ParameterConstraint& each) { return laws.has(each.name); });
  return of_laws;
}

/// Returns the variables that stand for the parameters of the laws, and where they start.
std::vector<detail::JointVariable> variables_of(const detail::Laws& laws,
                                                const std::vector<ParameterConstraint>& constraints,
                                                const StartValues& values, std::vector<double>& starts) {
  std::vector<detail::JointVariable> variables;
  if (laws.count() == 0) return variables;
  constexpr double widest = 1e300, widest_logarithm = 350;
  std::vector<double> given;
  for (const std::string& name : laws.names()) {
    const auto known = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    const bool any = known != constraints.end();
    given.push_back(any && known->start ? *known->start : nan);
    variables.push_back({name, false, any && known->lower ? std::max(*known->lower, -widest) : -widest,
                         any && known->upper ? std::min(*known->upper, widest) : widest});
  }
  starts = laws.starts(values.parameters, values.from_curve, given);
  for (std::size_t k = 0; k < variables.size(); ++k) {
    detail::JointVariable& each = variables[k];
    if (!(starts[k] > 0) || (each.lower < 0 && each.lower > -widest) || !laws.scales(k, starts)) continue;
    each.logarithmic = true;
    each.lower = each.lower > 0 ? std::log(each.lower) : -widest_logarithm;
    each.upper = each.upper < widest ? std::log(each.upper) : widest_logarithm;
  }
  return variables;
}

/// Starts of the shared variables: means of the fits alone by their errors, medians, and the values of the curve that
/// tells most of them together.
/// @param law_starts  of the parameters of the laws
std::vector<std::vector<double>> shared_starts(const detail::JointLayout& layout, const StartValues& values,
                                               const Alone& alone, const std::vector<double>& law_starts) {
  std::vector<double> mean(layout.shared.size()), median(mean), best(mean);
  std::size_t sharpest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < alone.size(); ++c) {
    double sum = 0;
    for (const auto& place : layout.free) {
      if (!place.shared || !alone[c]) continue;
      const ParameterEstimate& estimate = alone[c]->parameters[place.parameter];
      sum += std::abs(estimate.standard_error / estimate.value);
    }
    if (alone[c] && sum < least) {
      least = sum;
      sharpest = c;
    }
  }
  for (const auto& place : layout.free) {
    if (!place.shared) continue;
    const detail::JointVariable& variable = layout.variable(place);
    std::vector<double> all;
    double sum = 0, weights = 0;
    for (std::size_t c = 0; c < alone.size(); ++c) {
      if (!values.from_curve[c]) continue;
      const double here = variable.variable(values.parameters[c][place.parameter]);
      all.push_back(here);
      const ParameterEstimate& estimate = alone[c]->parameters[place.parameter];
      const double error = estimate.standard_error / std::abs(variable.derivative(here));
      if (!estimate.identified || !(error > 0)) continue;
      sum += here / (error * error);
      weights += 1 / (error * error);
    }
    if (all.empty()) all.push_back(variable.variable(values.parameters[0][place.parameter]));
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    median[place.index] = all[all.size() / 2];
    mean[place.index] = weights > 0 && std::isfinite(weights) ? sum / weights : median[place.index];
    best[place.index] = variable.variable(values.parameters[sharpest][place.parameter]);
  }
  const std::size_t first = layout.shared.size() - law_starts.size();
  for (std::size_t k = 0; k < law_starts.size(); ++k)
    for (auto* start : {&mean, &median, &best}) (*start)[first + k] = layout.shared[first + k].variable(law_starts[k]);
  std::vector<std::vector<double>> starts{mean};
  for (const auto& each : {median, best})
    if (std::find(starts.begin(), starts.end(), each) == starts.end()) starts.push_back(each);
  return starts;
}

std::vector<std::vector<double>> own_starts(const detail::JointLayout& layout, const StartValues& values) {
  std::vector<std::vector<double>> own(values.parameters.size(), std::vector<double>(layout.own.size()));
  for (std::size_t c = 0; c < own.size(); ++c)
    for (const auto& place : layout.free)
      if (!place.shared) own[c][place.index] = layout.own[place.index].variable(values.parameters[c][place.parameter]);
  return own;
}

/// The best of the searches from all starts, and how many ended there.
detail::JointPoint search(std::vector<detail::CurveResiduals>& curves, const detail::JointLayout& layout,
                          const std::vector<std::vector<double>>& shared, const std::vector<std::vector<double>>& own,
                          JointFitResult& result) {
  constexpr double coarse = 1e-7, settled = 1e-14, alike = 1e-5;
  std::vector<double> costs;
  detail::JointPoint best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& start : shared) {
    const detail::JointPoint point = joint_solve(curves, layout, {start, own, 0, false}, coarse);
    costs.push_back(point.cost);
    if (point.cost < best.cost) best = point;
  }
  result.starts = costs.size();
  if (!std::isfinite(best.cost)) return best;
  const auto count =
      std::count_if(costs.begin(), costs.end(), [&](double each) { return each <= best.cost * (1 + alike); });
  result.starts_at_best = static_cast<std::size_t>(count);
  return joint_solve(curves, layout, std::move(best), settled);
}

/// One estimate from a variable and the variance of it.
ParameterEstimate estimate_of(const detail::JointVariable& variable, double value, double variance, double half_width,
                              bool at_bound, double widening) {
  ParameterEstimate estimate{};
  estimate.name = variable.name;
  estimate.value = estimate.centre_value = variable.parameter(value);
  const double error = at_bound ? nan : std::sqrt(variance);
  estimate.standard_error = estimate.centre_standard_error = error * std::abs(variable.derivative(value));
  estimate.ci95_lower = variable.parameter(value - half_width * error);
  estimate.ci95_upper = variable.parameter(value + half_width * error);
  estimate.at_bound = at_bound;
  const double widest = std::max(estimate.value - estimate.ci95_lower, estimate.ci95_upper - estimate.value);
  estimate.identified = widest <= 0.5 * std::abs(estimate.value);  // false where there is no interval
  estimate.widening = widening;
  return estimate;
}

JointCurveResult describe_curve(const Structure& structure, const detail::JointLayout& layout, const detail::Laws& laws,
                                const detail::JointPoint& point, const detail::JointConfidence& found, std::size_t c,
                                const JointFitResult& so_far) {
  JointCurveResult result{};
  const std::size_t count = structure.parameter_names().size();
  result.parameters.resize(count);
  result.covariance.assign(count, std::vector<double>(count, 0.0));
  for (std::size_t i = 0; i < count; ++i) {
    ParameterEstimate& fixed = result.parameters[i];
    fixed.name = structure.parameter_names()[i];
    fixed.value = fixed.centre_value = layout.fixed[i];
    fixed.ci95_lower = fixed.ci95_upper = nan;
    fixed.fixed = fixed.identified = true;
  }
  for (const auto& place : layout.free)
    result.parameters[place.parameter] =
        place.shared
            ? so_far.shared[place.index]
            : estimate_of(
                  layout.own[place.index], point.own[c][place.index],
                  found.curve[c](static_cast<Eigen::Index>(place.index), static_cast<Eigen::Index>(place.index)),
                  found.half_width, found.own_at_bound[c][place.index], found.own_widening[c][place.index]);
  const auto slopes = layout.slopes(point.shared, point.own[c], c);
  for (const auto& a : slopes)
    for (const auto& b : slopes)
      result.covariance[a.parameter][b.parameter] +=
          a.slope * b.slope *
          found.curve[c](static_cast<Eigen::Index>(a.variable), static_cast<Eigen::Index>(b.variable));
  const std::vector<double> values = layout.parameters(point.shared, point.own[c], c);
  for (std::size_t i = 0; i < count; ++i) {
    if (!laws.drives(i)) continue;
    ParameterEstimate& estimate = result.parameters[i];
    estimate = {};
    estimate.name = structure.parameter_names()[i];
    estimate.value = estimate.centre_value = values[i];
    estimate.standard_error = estimate.centre_standard_error = std::sqrt(result.covariance[i][i]);
    const double half_width = found.half_width * estimate.standard_error;
    estimate.ci95_lower = values[i] - half_width;
    estimate.ci95_upper = values[i] + half_width;
    estimate.identified = half_width <= 0.5 * std::abs(values[i]);
  }
  return result;
}

void describe_residuals(JointCurveResult& result, detail::CurveResiduals& curve, const detail::JointPoint& point,
                        std::size_t c, const std::optional<FitResult>& alone) {
  std::vector<double> residual(curve.count());
  curve.evaluate(point.shared, point.own[c], residual.data(), nullptr);
  double square = 0;
  for (const double each : residual) {
    square += each * each;
    result.max_residual = std::max(result.max_residual, std::abs(each) * curve.noise());
  }
  result.residuals = residual.size();
  result.rms = std::sqrt(square / static_cast<double>(residual.size())) * curve.noise();
  result.rms_alone = alone ? alone->rms : nan;
  result.noise = curve.noise();
}

/// See JointFitResult::sharing_p_value.
double sharing_p_value(const JointFitResult& joint, const Alone& alone) {
  double cost = 0, parameters = 0;
  for (std::size_t c = 0; c < alone.size(); ++c) {
    if (!alone[c]) return nan;
    cost += alone[c]->cost / (joint.curves[c].noise * joint.curves[c].noise);
    parameters += static_cast<double>(alone[c]->free_parameters);
  }
  const double saved = parameters - static_cast<double>(joint.free_parameters);
  const double degrees = static_cast<double>(joint.residuals) - parameters;
  if (!(saved > 0) || !(degrees > 0) || !(cost > 0)) return nan;
  const double ratio = std::max(0.0, joint.cost - cost) / saved / (cost / degrees);
  return detail::fisher_f_above(ratio, saved, degrees);
}

std::string message_of(const JointFitResult& result, double noise_correlation) {
  if (!result.usable()) return "The solver stopped before the cost settled; the best point found is returned.";
  std::string text = std::to_string(result.starts_at_best) + " of " + std::to_string(result.starts) +
                     " joint searches ended at the best cost.";
  char more[240];
  constexpr double doubtful = 0.01, noticeable = 0.1;
  if (result.sharing_p_value < doubtful) {
    std::snprintf(more, sizeof more,
                  " The curves ask for separate values of what they are to share: fitted alone they leave so much less "
                  "that chance explains it with probability %.1e.",
                  result.sharing_p_value);
    text += more;
  }
  if (noise_correlation > noticeable) {
    std::snprintf(more, sizeof more,
                  " Neighbouring residuals go together (correlation %.2f on average), which the intervals allow for.",
                  noise_correlation);
    text += more;
  }
  return text;
}

}  // namespace

JointFitResult joint_fit(const std::vector<JointCurve>& curves, const Structure& structure,
                         const JointFitOptions& given) {
  const auto begin = std::chrono::steady_clock::now();
  if (curves.empty()) throw std::invalid_argument("there is no curve to fit");
  if (given.fit.loss != Loss::none) throw std::invalid_argument("joint fits take no robust loss");
  detail::require_function_of_s(structure);
  validate(given.fit.realisation);
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
  for (const JointCurve& curve : curves) {
    lower = std::min(lower, curve.data.omega().front());
    upper = std::max(upper, curve.data.omega().back());
  }
  const detail::Laws laws(structure, given, curves);
  JointFitOptions options = given;
  const std::vector<ParameterConstraint> of_laws = taken_out(options.fit.constraints, laws);
  for (ParameterConstraint& each : options.fit.constraints)
    if (laws.drives(structure.parameter_index(each.name)) && !each.fixed) each.lower = each.upper = std::nullopt;

  const Alone alone = detail::fit_alone(curves, structure, options);
  const StartValues values = start_values(structure, options, alone);
  std::vector<double> law_starts;
  const std::vector<detail::JointVariable> law_variables = variables_of(laws, of_laws, values, law_starts);
  const detail::JointLayout layout(structure, options, laws, law_variables, lower, upper);
  std::vector<detail::ResidualRule> rules;
  for (std::size_t c = 0; c < curves.size(); ++c)
    rules.push_back(
        detail::residual_rule(curves[c].data, alone[c] ? detail::settled(options.fit, *alone[c]) : options.fit));
  const std::vector<double> noise = noise_of(curves, rules, alone, options.fit.weight);
  std::vector<detail::CurveResiduals> problem;
  JointFitResult result{};
  result.model = structure.formula();
  for (std::size_t c = 0; c < curves.size(); ++c) {
    problem.emplace_back(curves[c].data, structure, options.fit.realisation, layout, c, rules[c], noise[c]);
    result.residuals += problem.back().count();
  }
  result.free_parameters = layout.shared.size() + curves.size() * layout.own.size();
  if (result.residuals < result.free_parameters)
    throw std::invalid_argument(detail::counted(result.residuals, "residual") + " cannot determine " +
                                detail::counted(result.free_parameters, "free parameter"));

  const detail::JointPoint point =
      search(problem, layout, shared_starts(layout, values, alone, law_starts), own_starts(layout, values), result);
  result.cost = point.cost;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (!std::isfinite(point.cost)) {
    result.termination = FitTermination::no_usable_start;
    result.message = "The model is not finite on these frequencies anywhere it was tried.";
    result.sharing_p_value = result.condition = result.half_width = nan;
    result.seconds = seconds();
    return result;
  }
  const detail::JointConfidence found = joint_confidence(problem, layout, point);
  result.termination = point.converged ? FitTermination::converged : FitTermination::not_converged;
  result.condition = found.condition;
  result.half_width = found.half_width;
  for (std::size_t k = 0; k < layout.shared.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    result.shared.push_back(estimate_of(layout.shared[k], point.shared[k], found.shared(i, i), found.half_width,
                                        found.shared_at_bound[k], found.shared_widening[k]));
  }
  for (std::size_t c = 0; c < curves.size(); ++c) {
    JointCurveResult curve = describe_curve(structure, layout, laws, point, found, c, result);
    curve.name = curves[c].name;
    describe_residuals(curve, problem[c], point, c, alone[c]);
    result.curves.push_back(std::move(curve));
  }
  result.sharing_p_value = sharing_p_value(result, alone);
  result.message = message_of(result, found.noise_correlation);
  result.seconds = seconds();
  return result;
}

std::string JointFitResult::summary() const {
  using detail::short_text;
  std::string text = model + ", " + detail::counted(curves.size(), "curve") + "\n";
  for (const ParameterEstimate& each : shared) {
    text += "  " + each.name + " = " + short_text(each.value);
    if (std::isfinite(each.ci95_lower) && std::isfinite(each.ci95_upper))
      text += ", 95 % within " + short_text(each.ci95_lower) + " .. " + short_text(each.ci95_upper);
    if (each.at_bound) text += ", at its bound";
    if (!each.identified) text += ", not identified";
    text += "\n";
  }
  return text + message;
}

}  // namespace frac
