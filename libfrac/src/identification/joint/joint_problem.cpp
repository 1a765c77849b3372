// SPDX-License-Identifier: BSD-3-Clause
#include "joint_problem.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <utility>

#include "identification/residuals/frequency_problem.hpp"
#include "identification/residuals/time_problem.hpp"

namespace frac::detail {
namespace {

// Logarithms of parameters without limits: all that doubles hold, with room for products of two.
constexpr double widest_logarithm = 350;

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw std::invalid_argument("parameter '" + name + "', which the curves have in common or by a law, " + reason);
}

}  // namespace

double JointVariable::parameter(double variable) const {
  return logarithmic ? std::exp(variable) : variable;
}

double JointVariable::variable(double parameter) const {
  const double value = logarithmic ? std::log(parameter) : parameter;
  return in_order ? value : std::clamp(value, lower, upper);
}

double JointVariable::derivative(double variable) const {
  return logarithmic ? std::exp(variable) : 1;
}

JointLayout::JointLayout(const Structure& structure, const JointFitOptions& options, const Laws& laws,
                         std::vector<JointVariable> law_variables,
                         const std::vector<ParameterConstraint>& law_constraints, double omega_lower,
                         double omega_upper)
    : laws_(laws) {
  const auto& names = structure.parameter_names();
  std::vector<bool> is_shared(names.size(), false);
  for (const std::string& name : options.shared) {
    const std::size_t i = structure.parameter_index(name);
    if (is_shared[i]) refuse(name, "is named twice");
    is_shared[i] = true;
  }
  if (options.shared.empty() && laws.count() == 0 && !options.shift)
    throw std::invalid_argument("no parameter is shared: fit each curve alone");

  // In units of 1 and 1 rad/s the map's variables are the parameters themselves or their logarithms.
  const ParameterMap map(structure, options.fit.constraints, {1, 1, 1, 1, omega_lower, omega_upper},
                         options.fit.component == Component::magnitude);
  fixed.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!map.is_fixed(i)) continue;
    if (is_shared[i] || laws.drives(i)) refuse(names[i], "is fixed");
    fixed[i] = map.start()[i];
  }
  for (const ParameterMap::Free& each : map.free()) {
    if (laws.drives(each.parameter)) continue;
    const bool in_common = is_shared[each.parameter];
    std::vector<JointVariable>& list = in_common ? shared : own;
    free.push_back({each.parameter, in_common, list.size(), no_place, 0});
    JointVariable variable{
        names[each.parameter], each.logarithmic, each.lower, each.upper, false, each.least, each.most};
    if (each.logarithmic && !each.bounded_by_user) {
      variable.lower = -widest_logarithm;
      variable.upper = widest_logarithm;
    }
    list.push_back(std::move(variable));
    free.back().most = each.most;
  }
  put_in_order(structure, options.fit.constraints);
  const std::size_t laws_begin = shared.size();
  for (const ParameterConstraint& each : options.fit.constraints) {
    if (!each.prior) continue;
    const std::size_t i = structure.parameter_index(each.name);
    check_prior(each.name, *each.prior);
    if (laws.drives(i)) throw std::invalid_argument("prior of parameter '" + each.name + "': it follows a law");
    (is_shared[i] ? shared_priors : own_priors).push_back({each.name, *each.prior, i, no_place});
  }
  if (options.shift) reference = options.shift->reference;
  shared.insert(shared.end(), std::make_move_iterator(law_variables.begin()),
                std::make_move_iterator(law_variables.end()));
  for (const ParameterConstraint& each : law_constraints) {
    if (!each.prior) continue;
    check_prior(each.name, *each.prior);
    const auto variable = std::find_if(shared.begin() + static_cast<std::ptrdiff_t>(laws_begin), shared.end(),
                                       [&](const JointVariable& known) { return known.name == each.name; });
    shared_priors.push_back({each.name, *each.prior, no_place, static_cast<std::size_t>(variable - shared.begin())});
  }
}

void JointLayout::put_in_order(const Structure& structure, const std::vector<ParameterConstraint>& constraints) {
  const auto place_of = [&](const std::string& name) {
    const std::size_t parameter = structure.parameter_index(name);
    return std::find_if(free.begin(), free.end(), [&](const Place& each) { return each.parameter == parameter; });
  };
  // As many passes as a chain has links bring each behind that which it is above.
  for (std::size_t pass = 0; pass < free.size(); ++pass) {
    for (const ParameterConstraint& each : constraints) {
      if (each.above.empty()) continue;
      const auto greater = place_of(each.name), lesser = place_of(each.above);
      if (greater != free.end() && lesser != free.end() && greater < lesser) std::rotate(greater, lesser, lesser + 1);
    }
  }
  for (const ParameterConstraint& each : constraints) {
    if (each.above.empty()) continue;
    const auto greater = place_of(each.name), lesser = place_of(each.above);
    const auto refuse_order = [&](const char* reason) {
      throw std::invalid_argument("parameter '" + each.name + "' is not to be below '" + each.above + "': " + reason);
    };
    if (laws_.drives(structure.parameter_index(each.name)) || laws_.drives(structure.parameter_index(each.above)))
      refuse_order("one of them follows a law");
    if (greater == free.end() || lesser == free.end()) continue;  // one is fixed, which the limits know
    if (greater->shared && !lesser->shared) refuse_order("it is shared and the other one is not");
    greater->above = static_cast<std::size_t>(lesser - free.begin());
    JointVariable& variable = greater->shared ? shared[greater->index] : own[greater->index];
    variable.in_order = true;
    variable.lower = 0;
    variable.upper = std::isfinite(greater->most) ? 1 : variable.logarithmic ? widest_logarithm : 1e300;
  }
}

double JointLayout::way_up(const Place& place, std::span<const double> parameters) const {
  if (!std::isfinite(place.most)) return 1;
  const double from = parameters[free[place.above].parameter];
  return variable(place).logarithmic ? std::log(place.most / from) : place.most - from;
}

bool JointLayout::is_held(std::size_t curve, std::size_t own_index) const {
  return curve == reference && (own[own_index].name == horizontal_shift || own[own_index].name == vertical_shift);
}

void JointLayout::take_order(std::vector<double>& shared_values, std::vector<double>& own_values) const {
  const auto value_of = [&](const Place& place) -> double& {
    return place.shared ? shared_values[place.index] : own_values[place.index];
  };
  std::vector<double> parameters(fixed.size());
  for (const Place& place : free) {
    const JointVariable& of = variable(place);
    parameters[place.parameter] = of.parameter(value_of(place));
    if (place.above == no_place) continue;
    const double from = parameters[free[place.above].parameter], way = way_up(place, parameters);
    double& value = parameters[place.parameter];
    value = std::max(value, from);
    const double up = of.logarithmic ? std::log(value / from) : value - from;
    value_of(place) = way > 0 ? std::clamp(up / way, of.lower, of.upper) : 0;
  }
}

JointLayout::Pull JointLayout::pull(const JointPrior& prior, std::span<const double> shared_values,
                                    std::span<const double> own_values, std::size_t curve) const {
  Pull result{0, std::vector<double>(own.size() + shared.size(), 0.0)};
  if (prior.law_variable != no_place) {
    const JointVariable& of = shared[prior.law_variable];
    const double at = shared_values[prior.law_variable], value = of.parameter(at);
    result.distance = prior.prior.distance(value);
    result.by_variable[own.size() + prior.law_variable] = prior.prior.slope(value) * of.derivative(at);
    return result;
  }
  const double value = parameters(shared_values, own_values, curve)[prior.parameter];
  result.distance = prior.prior.distance(value);
  for (const Slope& each : slopes(shared_values, own_values, curve))
    if (each.parameter == prior.parameter) result.by_variable[each.variable] += prior.prior.slope(value) * each.slope;
  return result;
}

std::vector<double> JointLayout::of_laws(std::span<const double> shared_values) const {
  std::vector<double> values;
  for (std::size_t k = shared.size() - laws_.names().size(); k < shared.size(); ++k)
    values.push_back(shared[k].parameter(shared_values[k]));
  return values;
}

std::vector<double> JointLayout::parameters(std::span<const double> shared_values, std::span<const double> own_values,
                                            std::size_t curve) const {
  std::vector<double> result = fixed;
  for (const Place& place : free) {
    const double value = place.shared ? shared_values[place.index] : own_values[place.index];
    if (place.above == no_place) {
      result[place.parameter] = variable(place).parameter(value);
      continue;
    }
    const double from = result[free[place.above].parameter], way = value * way_up(place, result);
    result[place.parameter] = variable(place).logarithmic ? from * std::exp(way) : from + way;
  }
  if (laws_.count() == 0) return result;
  const std::vector<double> values = of_laws(shared_values);
  std::vector<double> gradient(values.size());
  for (std::size_t l = 0; l < laws_.count(); ++l) result[laws_.parameter(l)] = laws_.at(l, curve, values, gradient);
  return result;
}

void JointLayout::add_slopes(const Place& place, double factor, std::size_t of_parameter,
                             std::span<const double> parameters, std::span<const double> shared_values,
                             std::span<const double> own_values, std::size_t curve, std::vector<Slope>& all) const {
  if (!place.shared && is_held(curve, place.index)) return;
  const std::size_t at = place.shared ? own.size() + place.index : place.index;
  const JointVariable& of = variable(place);
  const double value = place.shared ? shared_values[place.index] : own_values[place.index];
  if (place.above == no_place) {
    all.push_back({of_parameter, at, factor * of.derivative(value)});
    return;
  }
  const Place& lesser = free[place.above];
  const double unit = of.logarithmic ? parameters[place.parameter] : 1;
  const double from = of.logarithmic ? parameters[lesser.parameter] : 1;
  all.push_back({of_parameter, at, factor * unit * way_up(place, parameters)});
  const double left = std::isfinite(place.most) ? 1 - value : 1;
  add_slopes(lesser, factor * unit / from * left, of_parameter, parameters, shared_values, own_values, curve, all);
}

std::vector<JointLayout::Slope> JointLayout::slopes(std::span<const double> shared_values,
                                                    std::span<const double> own_values, std::size_t curve) const {
  std::vector<Slope> all;
  const std::vector<double> at = parameters(shared_values, own_values, curve);
  for (const Place& place : free) add_slopes(place, 1, place.parameter, at, shared_values, own_values, curve, all);
  if (laws_.count() > 0) {
    const std::vector<double> values = of_laws(shared_values);
    const std::size_t first = shared.size() - values.size();
    std::vector<double> gradient(values.size());
    for (std::size_t l = 0; l < laws_.count(); ++l) {
      static_cast<void>(laws_.at(l, curve, values, gradient));
      for (std::size_t k = 0; k < gradient.size(); ++k)
        if (gradient[k] != 0)
          all.push_back({laws_.parameter(l), own.size() + first + k,
                         gradient[k] * shared[first + k].derivative(shared_values[first + k])});
    }
  }
  std::stable_sort(all.begin(), all.end(), [](const Slope& a, const Slope& b) { return a.variable < b.variable; });
  return all;
}

std::unique_ptr<Problem> problem_of(const JointCurve& curve, const Structure& structure, const CurveOptions& settled) {
  if (const FrequencyResponseData* response = curve.response())
    return std::make_unique<FrequencyProblem>(*response, structure, std::get<FitOptions>(settled), ByParameters{});
  return std::make_unique<TimeProblem>(*curve.record(), structure, std::get<TimeFitOptions>(settled), ByParameters{});
}

CurveResiduals::CurveResiduals(std::unique_ptr<Problem> problem, const JointLayout& layout, std::size_t index,
                               double noise)
    : problem_(std::move(problem)),
      residuals_(problem_->residuals()),
      layout_(layout),
      index_(index),
      noise_(noise),
      by_parameters_(residuals_.count() * problem_->structure.parameter_names().size()) {}

bool CurveResiduals::evaluate(std::span<const double> shared, std::span<const double> own, double* residual,
                              double* jacobian) {
  const std::vector<double> parameters = layout_.parameters(shared, own, index_);
  if (!residuals_.evaluate(parameters, residual, jacobian ? by_parameters_.data() : nullptr)) return false;
  const double factor = problem_->unit / noise_;
  std::for_each_n(residual, count(), [&](double& each) { each *= factor; });
  for (std::size_t k = 0; k < layout_.own_priors.size(); ++k) {
    const JointLayout::Pull pull = layout_.pull(layout_.own_priors[k], shared, own, index_);
    const std::size_t row = count() + k;
    residual[row] = prior_weight_ * pull.distance;
    if (!std::isfinite(residual[row])) return false;
    for (std::size_t variable = 0; jacobian && variable < pull.by_variable.size(); ++variable)
      jacobian[variable * rows() + row] = prior_weight_ * pull.by_variable[variable];
  }
  if (!jacobian) return true;
  const std::size_t columns = layout_.own.size() + layout_.shared.size();
  for (std::size_t variable = 0; variable < columns; ++variable)
    std::fill_n(jacobian + variable * rows(), count(), 0.0);
  for (const JointLayout::Slope& each : layout_.slopes(shared, own, index_)) {
    const double slope = factor * each.slope;
    const double* const from = by_parameters_.data() + each.parameter * count();
    double* const to = jacobian + each.variable * rows();
    for (std::size_t row = 0; row < count(); ++row) to[row] += slope * from[row];
  }
  return true;
}

std::vector<double> CurveResiduals::of_data(std::span<const double> shared, std::span<const double> own) {
  std::vector<double> residual(rows());
  evaluate(shared, own, residual.data(), nullptr);
  residual.resize(count());
  return residual;
}

}  // namespace frac::detail
