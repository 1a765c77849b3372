// SPDX-License-Identifier: BSD-3-Clause
#include "joint_problem.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "identification/residuals/parameter_map.hpp"

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
  return std::clamp(logarithmic ? std::log(parameter) : parameter, lower, upper);
}

double JointVariable::derivative(double variable) const {
  return logarithmic ? std::exp(variable) : 1;
}

JointLayout::JointLayout(const Structure& structure, const JointFitOptions& options, const Laws& laws,
                         std::vector<JointVariable> law_variables, double omega_lower, double omega_upper)
    : laws_(laws) {
  const auto& names = structure.parameter_names();
  std::vector<bool> is_shared(names.size(), false);
  for (const std::string& name : options.shared) {
    const std::size_t i = structure.parameter_index(name);
    if (is_shared[i]) refuse(name, "is named twice");
    is_shared[i] = true;
  }
  if (options.shared.empty() && laws.count() == 0)
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
    free.push_back({each.parameter, in_common, list.size()});
    JointVariable variable{names[each.parameter], each.logarithmic, each.lower, each.upper};
    if (each.logarithmic && !each.bounded_by_user) {
      variable.lower = -widest_logarithm;
      variable.upper = widest_logarithm;
    }
    list.push_back(std::move(variable));
  }
  shared.insert(shared.end(), std::make_move_iterator(law_variables.begin()),
                std::make_move_iterator(law_variables.end()));
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
    result[place.parameter] = variable(place).parameter(value);
  }
  if (laws_.count() == 0) return result;
  const std::vector<double> values = of_laws(shared_values);
  std::vector<double> gradient(values.size());
  for (std::size_t l = 0; l < laws_.count(); ++l) result[laws_.parameter(l)] = laws_.at(l, curve, values, gradient);
  return result;
}

std::vector<JointLayout::Slope> JointLayout::slopes(std::span<const double> shared_values,
                                                    std::span<const double> own_values, std::size_t curve) const {
  std::vector<Slope> all;
  for (const Place& place : free)
    all.push_back({place.parameter, place.shared ? own.size() + place.index : place.index,
                   variable(place).derivative(place.shared ? shared_values[place.index] : own_values[place.index])});
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

CurveResiduals::CurveResiduals(const FrequencyResponseData& data, const Structure& structure,
                               const Realisation& realisation, const JointLayout& layout, std::size_t index,
                               ResidualRule rule, double noise)
    : data_(data),
      structure_(structure),
      realisation_(realisation),
      layout_(layout),
      index_(index),
      rule_(std::move(rule)),
      noise_(noise),
      value_(data.size()),
      gradient_(data.size() * structure.parameter_names().size()),
      column_(data.size()) {}

bool CurveResiduals::evaluate(std::span<const double> shared, std::span<const double> own, double* residual,
                              double* jacobian) {
  const std::vector<double> parameters = layout_.parameters(shared, own, index_);
  if (jacobian) {
    structure_.response_and_gradient(parameters, data_.omega(), realisation_, value_, gradient_);
  } else {
    structure_.response(parameters, data_.omega(), realisation_, value_);
  }
  if (!rule_.residuals(value_, data_.value(), residual)) return false;
  const double factor = rule_.unit / noise_;
  std::for_each_n(residual, count(), [&](double& each) { each *= factor; });
  if (!jacobian) return true;
  const auto slopes = layout_.slopes(shared, own, index_);
  const std::size_t columns = layout_.own.size() + layout_.shared.size();
  auto next = slopes.begin();
  for (std::size_t variable = 0; variable < columns; ++variable) {
    std::fill(column_.begin(), column_.end(), 0.0);
    for (; next != slopes.end() && next->variable == variable; ++next) {
      const auto of_parameter = std::span(gradient_).subspan(next->parameter * data_.size(), data_.size());
      const double slope = factor * next->slope;
      std::transform(of_parameter.begin(), of_parameter.end(), column_.begin(), column_.begin(),
                     [&](std::complex<double> each, std::complex<double> sum) { return sum + slope * each; });
    }
    if (!rule_.derivatives(value_, column_, jacobian + variable * count())) return false;
  }
  return true;
}

}  // namespace frac::detail
