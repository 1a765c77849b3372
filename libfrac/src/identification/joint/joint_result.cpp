// SPDX-License-Identifier: BSD-3-Clause
#include "joint_result.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "identification/statistics/estimates.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// One estimate from a variable and the variance of it.
ParameterEstimate estimate_of(const JointVariable& variable, double value, double variance, double half_width,
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
  estimate.lower_limit = variable.least;
  estimate.upper_limit = variable.most;
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

JointCurveResult describe_curve(const JointSolution& solution, std::size_t c,
                                const std::vector<ParameterEstimate>& shared) {
  const auto& [structure, layout, laws, point, found, alone] = solution;
  JointCurveResult result{};
  const std::size_t count = structure.parameter_names().size();
  result.parameters.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    ParameterEstimate& fixed = result.parameters[i];
    fixed.name = structure.parameter_names()[i];
    fixed.value = fixed.centre_value = fixed.lower_limit = fixed.upper_limit = layout.fixed[i];
    fixed.ci95_lower = fixed.ci95_upper = nan;
    fixed.fixed = fixed.identified = true;
  }
  for (const auto& place : layout.free)
    result.parameters[place.parameter] =
        place.shared
            ? shared[place.index]
            : estimate_of(
                  layout.own[place.index], point.own[c][place.index],
                  found.curve[c](static_cast<Eigen::Index>(place.index), static_cast<Eigen::Index>(place.index)),
                  found.half_width, found.own_at_bound[c][place.index], found.own_widening[c][place.index]);
  auto slopes = layout.slopes(point.shared, point.own[c], c);
  const std::size_t of_laws = laws.names().size(), first = layout.shared.size() - of_laws;
  for (std::size_t k = first; k < layout.shared.size(); ++k)
    slopes.push_back({count + k - first, layout.own.size() + k, layout.shared[k].derivative(point.shared[k])});
  auto& all = result.covariance_with_laws;
  all.assign(count + of_laws, std::vector<double>(count + of_laws, 0.0));
  for (const auto& a : slopes)
    for (const auto& b : slopes)
      all[a.parameter][b.parameter] +=
          a.slope * b.slope *
          found.curve[c](static_cast<Eigen::Index>(a.variable), static_cast<Eigen::Index>(b.variable));
  for (std::size_t i = 0; i < count; ++i)
    result.covariance.emplace_back(all[i].begin(), all[i].begin() + static_cast<std::ptrdiff_t>(count));
  const std::vector<double> values = layout.parameters(point.shared, point.own[c], c);
  for (std::size_t i = 0; i < count; ++i) {
    if (!laws.drives(i)) continue;
    ParameterEstimate& estimate = result.parameters[i];
    estimate = {};
    estimate.name = structure.parameter_names()[i];
    estimate.value = estimate.centre_value = values[i];
    const bool is_shift = estimate.name == horizontal_shift || estimate.name == vertical_shift;
    set_interval(estimate, result.covariance[i][i], found.half_width, is_shift && estimate.value > 0);
  }
  for (const auto& place : layout.free) {
    ParameterEstimate& estimate = result.parameters[place.parameter];
    if (place.above != JointLayout::no_place) {
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
  for (const JointPrior& prior : layout.own_priors) {
    const ParameterEstimate& estimate = result.parameters[prior.parameter];
    result.priors.push_back(prior_estimate(prior.name, prior.prior, estimate));
  }
  return result;
}

void describe_residuals(JointCurveResult& result, CurveResiduals& curve, const JointPoint& point, std::size_t c,
                        const std::optional<FitResult>& alone) {
  const std::vector<double> residual = curve.of_data(point.shared, point.own[c]);
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
double sharing_p_value(const JointFitResult& joint, double cost_together,
                       const std::vector<std::optional<FitResult>>& alone) {
  // Chance leaves so little of the noise to one curve of three degrees of freedom in a thousand, and to fewer of more:
  // it is met to rounding, and tells nothing of the noise of others.
  constexpr double met_to_rounding = 0.01;
  double cost = 0, unit = 0, parameters = 0, degrees = 0;
  for (std::size_t c = 0; c < alone.size(); ++c) {
    if (!alone[c]) return nan;
    const double variance = joint.curves[c].noise * joint.curves[c].noise;
    const double left = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    cost += alone[c]->loss_cost / variance;
    if (!(alone[c]->loss_unit < met_to_rounding * variance)) {
      unit += left * alone[c]->loss_unit / variance;
      degrees += left;
    }
    parameters += static_cast<double>(alone[c]->free_parameters);
  }
  const double saved = parameters - static_cast<double>(joint.free_parameters);
  if (!(saved > 0) || !(degrees > 0) || !(unit > 0)) return nan;
  const double ratio = std::max(0.0, cost_together - cost) / saved / (unit / degrees);
  return fisher_f_above(ratio, saved, degrees);
}

/// What the data alone cost together.
double cost_without_priors(std::vector<CurveResiduals>& curves, const JointLayout& layout, const JointPoint& point) {
  if (layout.shared_priors.empty() && layout.own_priors.empty()) return point.cost;
  const double weight = curves.front().prior_weight();
  for (CurveResiduals& curve : curves) curve.set_prior_weight(0);
  constexpr double cost_tolerance = 1e-10;
  const JointPoint without = joint_solve(curves, layout, point, cost_tolerance);
  for (CurveResiduals& curve : curves) curve.set_prior_weight(weight);
  return without.cost;
}

std::string message_of(const JointFitResult& result, double noise_correlation) {
  if (!result.usable()) return "The solver stopped before the cost settled; the best point found is returned.";
  std::string text = std::to_string(result.starts_at_best) + " of " + std::to_string(result.starts) +
                     " joint searches ended at the best cost.";
  char more[240];
  constexpr double doubtful = 0.01, noticeable = 0.1;
  if (!result.without_noise && result.sharing_p_value < doubtful) {
    std::snprintf(more, sizeof more,
                  " The curves ask for separate values of what they are to share: fitted alone they leave so much less "
                  "that chance explains it with probability %.1e.",
                  result.sharing_p_value);
    text += more;
  }
  std::vector<PriorEstimate> priors = result.priors;
  for (const JointCurveResult& curve : result.curves)
    priors.insert(priors.end(), curve.priors.begin(), curve.priors.end());
  text += remark_on_priors(priors);
  if (!result.without_noise && noise_correlation > noticeable) {
    std::snprintf(more, sizeof more,
                  " Neighbouring residuals go together (correlation %.2f on average), which the intervals allow for.",
                  noise_correlation);
    text += more;
  }
  return text;
}

/// The shared variables first, from which those parameters follow that are of all curves.
void describe_shared(const JointSolution& solution, JointFitResult& result) {
  const auto& [structure, layout, laws, point, found, alone] = solution;
  for (std::size_t k = 0; k < layout.shared.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    result.shared.push_back(estimate_of(layout.shared[k], point.shared[k], found.shared(i, i), found.half_width,
                                        found.shared_at_bound[k], found.shared_widening[k]));
  }
}

void describe_shared_priors(const JointLayout& layout, JointFitResult& result) {
  for (const JointPrior& prior : layout.shared_priors) {
    const auto of = std::find_if(result.shared.begin(), result.shared.end(),
                                 [&](const ParameterEstimate& each) { return each.name == prior.name; });
    result.priors.push_back(prior_estimate(prior.name, prior.prior, *of));
  }
}

}  // namespace

void describe_failure(double cost, JointFitResult& result) {
  result.termination = FitTermination::no_usable_start;
  result.message = "The model is not finite on these data anywhere it was tried.";
  result.cost = result.loss_cost = cost;
  result.sharing_p_value = result.condition = result.half_width = nan;
}

void describe(const JointSolution& solution, std::vector<CurveResiduals>& curves, JointFitResult& result) {
  const JointCost cost = cost_of_data(curves, solution.point);
  result.cost = cost.squares;
  result.loss_cost = cost.loss;
  result.termination = solution.point.converged ? FitTermination::converged : FitTermination::not_converged;
  result.condition = solution.found.condition;
  result.half_width = solution.found.half_width;
  result.effective_parameters = static_cast<double>(solution.found.rank) - solution.found.from_priors;
  for (const CurveResiduals& curve : curves) result.effective_parameters += static_cast<double>(curve.eliminated());
  describe_shared(solution, result);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    JointCurveResult curve = describe_curve(solution, c, result.shared);
    curve.name = result.curves[c].name;
    describe_residuals(curve, curves[c], solution.point, c, solution.alone[c]);
    result.curves[c] = std::move(curve);
  }
  for (const auto& place : solution.layout.free)
    if (place.shared) result.shared[place.index] = result.curves.front().parameters[place.parameter];
  describe_shared_priors(solution.layout, result);
  result.sharing_p_value =
      sharing_p_value(result, cost_without_priors(curves, solution.layout, solution.point), solution.alone);
  result.message = message_of(result, solution.found.noise_correlation);
}

}  // namespace detail

std::string JointFitResult::summary() const {
  std::string text = model + ", " + detail::counted(curves.size(), "curve") + "\n";
  for (const ParameterEstimate& each : shared) {
    text += detail::summary_line(each, without_noise);
  }
  return text + message + (without_noise ? "\n" + std::string(no_noise_sentence) : "");
}

}  // namespace frac
