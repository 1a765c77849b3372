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
#include "frac/identification/constraints.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/formula_checks.hpp"
#include "identification/search/robust.hpp"
#include "identification/statistics/estimates.hpp"
#include "joint_confidence.hpp"
#include "noise_levels.hpp"
#include "shift.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

using Alone = std::vector<std::optional<FitResult>>;

/// Standard deviations as far as their levels differ no more than chance makes them.
std::vector<double> moderated(const std::vector<detail::CurveVariance>& told) {
  std::vector<double> deviation = detail::moderated_variances(told);
  for (double& each : deviation) each = std::sqrt(each);
  return deviation;
}

/// Standard deviation of a residual of each curve, of the well-behaved ones under a loss.
std::vector<double> noise_of(const std::vector<JointCurve>& curves, const std::vector<detail::ResidualRule>& rules,
                             const Alone& alone, const FitOptions& options) {
  if (options.weight == Weight::given || options.weight == Weight::repeats)
    return std::vector<double>(curves.size(), 1.0);
  std::vector<detail::CurveVariance> told(curves.size(), {0, 0});
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (!alone[c]) continue;
    const double degrees = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    // An exact fit leaves rounding, of which no less than this is meant.
    const double rounding = 1e-14 * rules[c].unit;
    if (!(degrees > 0)) continue;
    const double spread = alone[c]->loss_scale / detail::tuning_constant(options.loss);
    const double variance = options.loss == Loss::none ? alone[c]->cost / degrees : spread * spread;
    told[c] = {std::max(variance, rounding * rounding), degrees};
  }
  return moderated(told);
}

/// The loss of each curve at the scale of its fit alone, or at that of its noise.
void set_losses(std::vector<detail::CurveResiduals>& curves, const Alone& alone, const FitOptions& options) {
  for (std::size_t c = 0; c < curves.size() && options.loss != Loss::none; ++c) {
    const double scale = options.loss_scale ? *options.loss_scale
                         : alone[c]         ? alone[c]->loss_scale
                                            : detail::tuning_constant(options.loss) * curves[c].noise();
    curves[c].set_loss(options.loss, scale / curves[c].noise());
  }
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
      if (known == options.fit.constraints.end() || !(known->start || known->fixed || known->prior))
        throw std::invalid_argument("no curve alone determines all parameters of " + structure.formula() +
                                    "; give a start value for '" + name + "'");
      otherwise.push_back(known->start ? *known->start : known->fixed ? *known->fixed : known->prior->value);
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
    if (any && !known->above.empty())
      throw std::invalid_argument("parameter '" + name + "' is of a law, and stands in no order of parameters");
    given.push_back(!any ? nan : known->start ? *known->start : known->prior ? known->prior->value : nan);
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
  // What is known beforehand is a start as well.
  std::vector<double> known = mean;
  for (const detail::JointPrior& prior : layout.shared_priors) {
    for (const auto& place : layout.free) {
      if (place.shared && place.parameter == prior.parameter)
        known[place.index] = layout.variable(place).variable(prior.prior.value);
    }
    if (prior.law_variable != detail::JointLayout::no_place)
      known[prior.law_variable] = layout.shared[prior.law_variable].variable(prior.prior.value);
  }
  std::vector<std::vector<double>> starts{mean};
  for (const auto& each : {median, best, known})
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
    detail::JointPoint at{start, own, 0, false};
    for (std::vector<double>& values : at.own) {
      at.shared = start;
      layout.take_order(at.shared, values);
    }
    const detail::JointPoint point = joint_solve(curves, layout, std::move(at), coarse);
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

/// The interval of a parameter that depends on several variables, by its variance; even in the logarithm of one that is
/// fitted so.
void set_interval(ParameterEstimate& estimate, double variance, double half_width, bool logarithmic) {
  estimate.standard_error = estimate.centre_standard_error = std::sqrt(variance);
  const double width = half_width * estimate.standard_error;
  const double factor = logarithmic ? std::exp(width / estimate.value) : 1;
  estimate.ci95_lower = logarithmic ? estimate.value / factor : estimate.value - width;
  estimate.ci95_upper = logarithmic ? estimate.value * factor : estimate.value + width;
  const double widest = std::max(estimate.value - estimate.ci95_lower, estimate.ci95_upper - estimate.value);
  estimate.identified = widest <= 0.5 * std::abs(estimate.value);
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
    set_interval(estimate, result.covariance[i][i], found.half_width, false);
  }
  for (const auto& place : layout.free) {
    ParameterEstimate& estimate = result.parameters[place.parameter];
    if (place.above != detail::JointLayout::no_place) {
      estimate.value = estimate.centre_value = values[place.parameter];
      const double variance = result.covariance[place.parameter][place.parameter];
      set_interval(estimate, estimate.at_bound ? nan : variance, found.half_width, layout.variable(place).logarithmic);
    }
    if (place.shared || !layout.is_held(c, place.index)) continue;
    estimate.value = estimate.centre_value = 1;
    estimate.standard_error = estimate.centre_standard_error = 0;
    estimate.ci95_lower = estimate.ci95_upper = nan;
    estimate.fixed = estimate.identified = true;
  }
  for (const detail::JointPrior& prior : layout.own_priors) {
    const ParameterEstimate& estimate = result.parameters[prior.parameter];
    result.priors.push_back(detail::prior_estimate(prior.name, prior.prior, estimate.value, estimate.standard_error));
  }
  return result;
}

void describe_residuals(JointCurveResult& result, detail::CurveResiduals& curve, const detail::JointPoint& point,
                        std::size_t c, const std::optional<FitResult>& alone) {
  std::vector<double> residual(curve.rows());
  curve.evaluate(point.shared, point.own[c], residual.data(), nullptr);
  residual.resize(curve.count());
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

/// See JointFitResult::sharing_p_value.  Under a loss the test takes its rise in units of the loss (Schrader,
/// Hettmansperger 1980).
/// @param cost_together  of the joint fit without priors
double sharing_p_value(const JointFitResult& joint, double cost_together, const Alone& alone) {
  double cost = 0, unit = 0, parameters = 0;
  for (std::size_t c = 0; c < alone.size(); ++c) {
    if (!alone[c]) return nan;
    const double variance = joint.curves[c].noise * joint.curves[c].noise;
    const double degrees = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    cost += alone[c]->loss_cost / variance;
    unit += degrees * alone[c]->loss_unit / variance;
    parameters += static_cast<double>(alone[c]->free_parameters);
  }
  const double saved = parameters - static_cast<double>(joint.free_parameters);
  const double degrees = static_cast<double>(joint.residuals) - parameters;
  if (!(saved > 0) || !(degrees > 0) || !(unit > 0)) return nan;
  const double ratio = std::max(0.0, cost_together - cost) / saved / (unit / degrees);
  return detail::fisher_f_above(ratio, saved, degrees);
}

/// What the data alone cost together.
double cost_without_priors(std::vector<detail::CurveResiduals>& curves, const detail::JointLayout& layout,
                           const detail::JointPoint& point) {
  if (layout.shared_priors.empty() && layout.own_priors.empty()) return point.cost;
  const double weight = curves.front().prior_weight();
  for (detail::CurveResiduals& curve : curves) curve.set_prior_weight(0);
  constexpr double cost_tolerance = 1e-10;
  const detail::JointPoint without = joint_solve(curves, layout, point, cost_tolerance);
  for (detail::CurveResiduals& curve : curves) curve.set_prior_weight(weight);
  return without.cost;
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
  std::vector<PriorEstimate> priors = result.priors;
  for (const JointCurveResult& curve : result.curves)
    priors.insert(priors.end(), curve.priors.begin(), curve.priors.end());
  text += detail::remark_on_priors(priors);
  if (noise_correlation > noticeable) {
    std::snprintf(more, sizeof more,
                  " Neighbouring residuals go together (correlation %.2f on average), which the intervals allow for.",
                  noise_correlation);
    text += more;
  }
  return text;
}

}  // namespace

namespace {

/// What is known before the curves are fitted together.
struct Preparation {
  Alone alone;
  StartValues values;
  std::vector<detail::ResidualRule> rules;
  std::vector<double> noise;
};

Preparation from_fits_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                            const JointFitOptions& options) {
  JointFitOptions without_priors = options;
  for (ParameterConstraint& each : without_priors.fit.constraints) each.prior = std::nullopt;
  Preparation result{detail::fit_alone(curves, structure, without_priors), {}, {}, {}};
  result.values = start_values(structure, options, result.alone);
  for (std::size_t c = 0; c < curves.size(); ++c)
    result.rules.push_back(detail::residual_rule(
        curves[c].data, result.alone[c] ? detail::settled(options.fit, *result.alone[c]) : options.fit));
  result.noise = noise_of(curves, result.rules, result.alone, options.fit);
  return result;
}

/// Standard deviations of the residuals of each curve as a joint solution leaves them, which has taken its share of
/// the shared variables from each.
std::vector<double> noise_left(std::vector<detail::CurveResiduals>& curves, const detail::JointLayout& layout,
                               const detail::JointPoint& point, Loss loss) {
  std::size_t total = 0;
  for (const detail::CurveResiduals& curve : curves) total += curve.count();
  std::vector<detail::CurveVariance> told;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double> residual(curves[c].rows());
    curves[c].evaluate(point.shared, point.own[c], residual.data(), nullptr);
    residual.resize(curves[c].count());
    const auto count = static_cast<double>(residual.size());
    const double degrees = count - static_cast<double>(layout.own.size()) -
                           static_cast<double>(layout.shared.size()) * count / static_cast<double>(total);
    double square = 0;
    for (const double each : residual) square += each * each;
    const double spread = detail::robust_spread(residual);
    const double variance = loss == Loss::none ? square / degrees : spread * spread;
    constexpr double rounding = 1e-14;
    if (degrees > 0)
      told.push_back({std::max(variance, rounding * rounding) * curves[c].noise() * curves[c].noise(), degrees});
    else
      told.push_back({0, 0});
  }
  return moderated(told);
}

Preparation from_superposition(const std::vector<JointCurve>& curves, const Structure& master,
                               const Structure& structure, const JointFitOptions& options) {
  FitOptions of_master = options.fit;
  std::erase_if(of_master.constraints, [](const ParameterConstraint& each) {
    return each.name == horizontal_shift || each.name == vertical_shift;
  });
  const detail::Superposition found = detail::superposed(curves, master, *options.shift, of_master);
  if (!found.master.usable())
    throw std::invalid_argument("no fit of " + master.formula() + " to all curves as one: " + found.master.message);
  Preparation result{Alone(curves.size()), {}, {}, std::vector<double>(curves.size(), found.master.rms)};
  if (!(found.master.rms > 0) || options.fit.weight == Weight::given) result.noise.assign(curves.size(), 1.0);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    std::vector<double>& values = result.values.parameters.emplace_back();
    for (const std::string& name : structure.parameter_names()) {
      const auto& known = found.master.parameters;
      const auto of = std::find_if(known.begin(), known.end(), [&](const auto& each) { return each.name == name; });
      values.push_back(name == horizontal_shift ? found.horizontal[c]
                       : name == vertical_shift ? found.vertical[c]
                                                : of->value);
    }
    result.values.from_curve.push_back(false);
    result.rules.push_back(detail::residual_rule(curves[c].data, detail::settled(options.fit, found.master)));
  }
  return result;
}

/// Shift factors are positive, whatever else is known of them.
void keep_shifts_positive(std::vector<ParameterConstraint>& constraints, const CurveShift& shift) {
  for (const char* name : {horizontal_shift, vertical_shift}) {
    if (name == vertical_shift && !shift.vertical) continue;
    ParameterConstraint& each = constraint_of(constraints, name);
    constexpr double largest = 1e150;
    if (!each.fixed && !each.upper) each.upper = largest;
  }
}

/// Priors weigh against the residuals by the noise that these tell, so that the solution moves until that stays.
detail::JointConfidence weighed_confidence(std::vector<detail::CurveResiduals>& curves,
                                           const detail::JointLayout& layout, detail::JointPoint& point) {
  constexpr double least = 1e-9;  // of the noise of the fits alone
  constexpr double settled = 1e-4;
  constexpr int most_rounds = 20;
  detail::JointConfidence found = joint_confidence(curves, layout, point);
  if (layout.shared_priors.empty() && layout.own_priors.empty()) return found;
  for (int round = 0; round < most_rounds && found.loss_unit >= 0; ++round) {
    const double noise = std::max(std::sqrt(found.loss_unit), least);
    if (std::abs(noise - curves.front().prior_weight()) <= settled * noise) break;
    for (detail::CurveResiduals& curve : curves) curve.set_prior_weight(noise);
    constexpr double cost_tolerance = 1e-14;
    point = joint_solve(curves, layout, std::move(point), cost_tolerance);
    found = joint_confidence(curves, layout, point);
  }
  return found;
}

}  // namespace

JointFitResult joint_fit(const std::vector<JointCurve>& curves, const Structure& master, const JointFitOptions& given) {
  const auto begin = std::chrono::steady_clock::now();
  if (curves.empty()) throw std::invalid_argument("there is no curve to fit");
  detail::require_function_of_s(master);
  validate(given.fit.realisation);
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
  for (const JointCurve& curve : curves) {
    lower = std::min(lower, curve.data.omega().front());
    upper = std::max(upper, curve.data.omega().back());
  }
  JointFitOptions options = given;
  if (given.shift) keep_shifts_positive(options.fit.constraints, *given.shift);
  const Structure structure = given.shift ? shifted(master, *given.shift) : master;
  const detail::Laws laws(structure, given, curves);
  const std::vector<ParameterConstraint> of_laws = taken_out(options.fit.constraints, laws);
  for (ParameterConstraint& each : options.fit.constraints)
    if (laws.drives(structure.parameter_index(each.name)) && !each.fixed) each.lower = each.upper = std::nullopt;

  const Preparation known = given.shift ? from_superposition(curves, master, structure, options)
                                        : from_fits_alone(curves, structure, options);
  const Alone& alone = known.alone;
  std::vector<double> law_starts;
  const std::vector<detail::JointVariable> law_variables = variables_of(laws, of_laws, known.values, law_starts);
  const detail::JointLayout layout(structure, options, laws, law_variables, of_laws, lower, upper);
  std::vector<detail::CurveResiduals> problem;
  JointFitResult result{};
  result.model = structure.formula();
  std::size_t held = 0;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    problem.emplace_back(curves[c].data, structure, options.fit.realisation, layout, c, known.rules[c], known.noise[c]);
    result.residuals += problem.back().count();
    for (std::size_t k = 0; k < layout.own.size(); ++k) held += layout.is_held(c, k) ? 1 : 0;
  }
  set_losses(problem, alone, options.fit);
  result.free_parameters = layout.shared.size() + curves.size() * layout.own.size() - held;
  if (result.residuals < result.free_parameters)
    throw std::invalid_argument(detail::counted(result.residuals, "residual") + " cannot determine " +
                                detail::counted(result.free_parameters, "free parameter"));

  const auto searched = [&] {
    return search(problem, layout, shared_starts(layout, known.values, alone, law_starts),
                  own_starts(layout, known.values), result);
  };
  detail::JointPoint point = searched();
  if (given.shift && given.fit.weight != Weight::given && std::isfinite(point.cost)) {
    const std::vector<double> noise = noise_left(problem, layout, point, options.fit.loss);
    for (std::size_t c = 0; c < problem.size(); ++c) problem[c].set_noise(noise[c]);
    set_losses(problem, alone, options.fit);
    point = searched();
  }
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (!std::isfinite(point.cost)) {
    result.termination = FitTermination::no_usable_start;
    result.message = "The model is not finite on these frequencies anywhere it was tried.";
    result.cost = result.loss_cost = point.cost;
    result.sharing_p_value = result.condition = result.half_width = nan;
    result.seconds = seconds();
    return result;
  }
  const detail::JointConfidence found = weighed_confidence(problem, layout, point);
  const detail::JointCost cost = cost_of_data(problem, point);
  result.cost = cost.squares;
  result.loss_cost = cost.loss;
  result.termination = point.converged ? FitTermination::converged : FitTermination::not_converged;
  result.condition = found.condition;
  result.half_width = found.half_width;
  result.effective_parameters = static_cast<double>(found.rank) - found.from_priors;
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
  for (const auto& place : layout.free)
    if (place.shared) result.shared[place.index] = result.curves.front().parameters[place.parameter];
  for (const detail::JointPrior& prior : layout.shared_priors) {
    const auto of = std::find_if(result.shared.begin(), result.shared.end(),
                                 [&](const ParameterEstimate& each) { return each.name == prior.name; });
    result.priors.push_back(detail::prior_estimate(prior.name, prior.prior, of->value, of->standard_error));
  }
  result.sharing_p_value = sharing_p_value(result, cost_without_priors(problem, layout, point), alone);
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
