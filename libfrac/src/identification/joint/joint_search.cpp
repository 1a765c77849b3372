// SPDX-License-Identifier: BSD-3-Clause
#include "joint_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "base/counted.hpp"
#include "identification/residuals/time_problem.hpp"
#include "identification/search/robust.hpp"
#include "noise_levels.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// The loss of each curve at the scale of its fit alone, or at that of its noise.
void set_losses(std::vector<CurveResiduals>& curves, const Alone& alone, const FitOptions& options) {
  for (std::size_t c = 0; c < curves.size() && options.loss != Loss::none; ++c) {
    const double scale = options.loss_scale ? *options.loss_scale
                         : alone[c]         ? alone[c]->loss_scale
                                            : tuning_constant(options.loss) * curves[c].noise();
    curves[c].set_loss(options.loss, scale / curves[c].noise());
  }
}

/// Starts of the shared variables: means of the fits alone by their errors, medians, and the values of the curve that
/// tells most of them together.
/// @param law_starts  of the parameters of the laws
std::vector<std::vector<double>> shared_starts(const JointLayout& layout, const StartValues& values, const Alone& alone,
                                               const std::vector<double>& law_starts) {
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
    const JointVariable& variable = layout.variable(place);
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
  // Values known beforehand are a start as well.
  std::vector<double> known = mean;
  for (const JointPrior& prior : layout.shared_priors) {
    for (const auto& place : layout.free) {
      if (place.shared && place.parameter == prior.parameter)
        known[place.index] = layout.variable(place).variable(prior.prior.value);
    }
    if (prior.law_variable != JointLayout::no_place)
      known[prior.law_variable] = layout.shared[prior.law_variable].variable(prior.prior.value);
  }
  std::vector<std::vector<double>> starts{mean};
  for (const auto& each : {median, best, known})
    if (std::find(starts.begin(), starts.end(), each) == starts.end()) starts.push_back(each);
  return starts;
}

std::vector<std::vector<double>> own_starts(const JointLayout& layout, const StartValues& values) {
  std::vector<std::vector<double>> own(values.parameters.size(), std::vector<double>(layout.own.size()));
  for (std::size_t c = 0; c < own.size(); ++c)
    for (const auto& place : layout.free)
      if (!place.shared) own[c][place.index] = layout.own[place.index].variable(values.parameters[c][place.parameter]);
  return own;
}

/// The best of the searches from all starts, and how many ended there.
JointPoint search(std::vector<CurveResiduals>& curves, const JointLayout& layout,
                  const std::vector<std::vector<double>>& shared, const std::vector<std::vector<double>>& own,
                  JointFitResult& result) {
  constexpr double coarse = 1e-7, settled = 1e-14, alike = 1e-5;
  std::vector<double> costs;
  JointPoint best;
  best.cost = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& start : shared) {
    JointPoint at{start, own, 0, false};
    for (std::vector<double>& values : at.own) {
      at.shared = start;
      layout.take_order(at.shared, values);
    }
    const JointPoint point = joint_solve(curves, layout, std::move(at), coarse);
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

/// Standard deviations of the residuals of each curve as a joint solution leaves them, which has taken its share of
/// the shared variables from each.
std::vector<double> noise_left(std::vector<CurveResiduals>& curves, const JointLayout& layout, const JointPoint& point,
                               Loss loss) {
  std::size_t total = 0;
  for (const CurveResiduals& curve : curves) total += curve.count();
  std::vector<CurveVariance> estimated;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const std::vector<double> residual = curves[c].of_data(point.shared, point.own[c]);
    const auto count = static_cast<double>(residual.size());
    const double degrees = count - static_cast<double>(layout.own.size()) -
                           static_cast<double>(layout.shared.size()) * count / static_cast<double>(total);
    double square = 0;
    for (const double each : residual) square += each * each;
    const double spread = robust_spread(residual);
    const double variance = loss == Loss::none ? square / degrees : spread * spread;
    constexpr double rounding = 1e-14;
    if (degrees > 0)
      estimated.push_back({std::max(variance, rounding * rounding) * curves[c].noise() * curves[c].noise(), degrees});
    else
      estimated.push_back({0, 0});
  }
  return moderated_deviations(estimated);
}

/// The residuals of each curve, weighed as the fits alone say.
std::vector<CurveResiduals> residuals_of(const std::vector<JointCurve>& curves, const Structure& structure,
                                         const FitOptions& options, const JointLayout& layout,
                                         const Preparation& known) {
  std::vector<CurveResiduals> problem;
  for (std::size_t c = 0; c < curves.size(); ++c)
    problem.emplace_back(problem_of(curves[c], structure, known.settled[c]), layout, c, known.noise[c]);
  set_losses(problem, known.alone, options);
  return problem;
}

/// @throws std::invalid_argument  there are more free parameters than residuals
void count(const std::vector<CurveResiduals>& problem, const JointLayout& layout, JointFitResult& result) {
  std::size_t held = 0;
  for (std::size_t c = 0; c < problem.size(); ++c) {
    result.residuals += problem[c].count();
    result.free_parameters += problem[c].eliminated();
    for (std::size_t k = 0; k < layout.own.size(); ++k) held += layout.is_held(c, k) ? 1 : 0;
  }
  result.free_parameters += layout.shared.size() + problem.size() * layout.own.size() - held;
  if (result.residuals < result.free_parameters)
    throw std::invalid_argument(counted(result.residuals, "residual") + " cannot determine " +
                                counted(result.free_parameters, "free parameter"));
}

struct OmegaRange {
  double lower = std::numeric_limits<double>::infinity(), upper = 0;
};
OmegaRange range_of(const std::vector<JointCurve>& curves) {
  OmegaRange range;
  for (const JointCurve& curve : curves) {
    if (const FrequencyResponseData* response = curve.response()) {
      range.lower = std::min(range.lower, response->omega().front());
      range.upper = std::max(range.upper, response->omega().back());
      continue;
    }
    // A dead time as long as the record, and periods of two samples.
    const TimeResponseData& record = *curve.record();
    const double length = length_of(record);
    range.lower = std::min(range.lower, 2 * std::numbers::pi / length);
    range.upper = std::max(range.upper, std::numbers::pi * static_cast<double>(record.size() - 1) / length);
  }
  return range;
}

}  // namespace

std::vector<ParameterConstraint> taken_out(std::vector<ParameterConstraint>& constraints, const Laws& laws) {
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

void free_driven(std::vector<ParameterConstraint>& constraints, const Structure& structure, const Laws& laws) {
  for (ParameterConstraint& each : constraints)
    if (laws.drives(structure.parameter_index(each.name)) && !each.fixed) each.lower = each.upper = std::nullopt;
}

std::vector<double> given_starts(const Laws& laws, const std::vector<ParameterConstraint>& constraints) {
  std::vector<double> given;
  for (const std::string& name : laws.names()) {
    const auto known = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    given.push_back(known == constraints.end() ? nan
                    : known->start             ? *known->start
                    : known->prior             ? known->prior->value
                                               : nan);
  }
  return given;
}

std::vector<JointVariable> variables_of(const Laws& laws, const std::vector<ParameterConstraint>& constraints,
                                        const StartValues& values, std::vector<double>& starts) {
  std::vector<JointVariable> variables;
  if (laws.count() == 0) return variables;
  constexpr double widest = 1e300, widest_logarithm = 350;
  for (const std::string& name : laws.names()) {
    const auto known = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    const bool any = known != constraints.end();
    if (any && !known->above.empty())
      throw std::invalid_argument("parameter '" + name + "' is of a law, and stands in no order of parameters");
    variables.push_back({name, false, any && known->lower ? std::max(*known->lower, -widest) : -widest,
                         any && known->upper ? std::min(*known->upper, widest) : widest});
    if (any && known->lower) variables.back().least = *known->lower;
    if (any && known->upper) variables.back().most = *known->upper;
  }
  starts = values.of_laws.empty()
               ? laws.starts(values.parameters, values.lead_laws, given_starts(laws, constraints)).front()
               : values.of_laws;
  for (std::size_t k = 0; k < variables.size(); ++k) {
    JointVariable& each = variables[k];
    if (!(starts[k] > 0) || (each.lower < 0 && each.lower > -widest) || !laws.scales(k, starts)) continue;
    each.logarithmic = true;
    each.lower = each.lower > 0 ? std::log(each.lower) : -widest_logarithm;
    each.upper = each.upper < widest ? std::log(each.upper) : widest_logarithm;
  }
  return variables;
}

JointSearch::JointSearch(const std::vector<JointCurve>& curves, const Structure& structure, JointFitOptions options,
                         const Preparation& known, const Laws& laws) {
  const std::vector<ParameterConstraint> of_laws = taken_out(options.fit.constraints, laws);
  free_driven(options.fit.constraints, structure, laws);
  std::vector<double> law_starts;
  const std::vector<JointVariable> variables = variables_of(laws, of_laws, known.values, law_starts);
  const OmegaRange range = range_of(curves);
  layout_.emplace(structure, options, laws, variables, of_laws, range.lower, range.upper);
  problem_ = residuals_of(curves, structure, options.fit, *layout_, known);
  shared_ = shared_starts(*layout_, known.values, known.alone, law_starts);
  own_ = own_starts(*layout_, known.values);
}

void JointSearch::run(const JointFitOptions& options, const Preparation& known, JointFitResult& result) {
  count(problem_, *layout_, result);
  point = search(problem_, *layout_, shared_, own_, result);
  if (!std::isfinite(point.cost)) return;
  squares_at_known_noise = cost_of_data(problem_, point).squares;
  unlikelihood = point.cost;
  if (!options.shift || options.fit.weight == Weight::given) return;
  noise = noise_left(problem_, *layout_, point, options.fit.loss);
  const auto weigh_by = [&](const std::vector<double>& deviations) {
    for (std::size_t c = 0; c < problem_.size(); ++c) problem_[c].set_noise(deviations[c]);
    set_losses(problem_, known.alone, options.fit);
  };
  weigh_by(noise);
  point = search(problem_, *layout_, shared_, own_, result);
  // The search under the noise found may have come to a better place under the noise known too.
  weigh_by(known.noise);
  squares_at_known_noise = std::min(squares_at_known_noise, cost_of_data(problem_, point).squares);
  weigh_by(noise);
  unlikelihood = point.cost;
  for (const CurveResiduals& curve : problem_)
    unlikelihood += 2 * static_cast<double>(curve.count()) * std::log(curve.noise());
}

}  // namespace frac::detail
