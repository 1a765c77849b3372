// SPDX-License-Identifier: BSD-3-Clause
#include "joint_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "identification/residuals/parameter_map.hpp"

namespace frac::detail {
namespace {

// Logarithms of parameters without limits: all that doubles hold, with room for products of two.
constexpr double widest_logarithm = 350;

[[noreturn]] void refuse(const std::string& name, const std::string& reason) {
  throw std::invalid_argument("shared parameter '" + name + "' " + reason);
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

JointLayout::JointLayout(const Structure& structure, const JointFitOptions& options, double omega_lower,
                         double omega_upper) {
  const auto& names = structure.parameter_names();
  std::vector<bool> is_shared(names.size(), false);
  for (const std::string& name : options.shared) {
    const std::size_t i = structure.parameter_index(name);
    if (is_shared[i]) refuse(name, "is named twice");
    is_shared[i] = true;
  }
  if (options.shared.empty()) throw std::invalid_argument("no parameter is shared: fit each curve alone");

  // In units of 1 and 1 rad/s the map's variables are the parameters themselves or their logarithms.
  const ParameterMap map(structure, options.fit.constraints, {1, 1, 1, 1, omega_lower, omega_upper},
                         options.fit.component == Component::magnitude);
  fixed.assign(names.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!map.is_fixed(i)) continue;
    if (is_shared[i]) refuse(names[i], "is fixed");
    fixed[i] = map.start()[i];
  }
  for (const ParameterMap::Free& each : map.free()) {
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
}

std::vector<double> JointLayout::parameters(std::span<const double> shared_values,
                                            std::span<const double> own_values) const {
  std::vector<double> result = fixed;
  for (const Place& place : free) {
    const double value = place.shared ? shared_values[place.index] : own_values[place.index];
    result[place.parameter] = variable(place).parameter(value);
  }
  return result;
}

CurveResiduals::CurveResiduals(const FrequencyResponseData& data, const Structure& structure,
                               const Realisation& realisation, const JointLayout& layout, ResidualRule rule,
                               double noise)
    : data_(data),
      structure_(structure),
      realisation_(realisation),
      layout_(layout),
      rule_(std::move(rule)),
      noise_(noise),
      value_(data.size()),
      gradient_(data.size() * structure.parameter_names().size()),
      column_(data.size()) {}

bool CurveResiduals::evaluate(std::span<const double> shared, std::span<const double> own, double* residual,
                              double* jacobian) {
  const std::vector<double> parameters = layout_.parameters(shared, own);
  if (jacobian) {
    structure_.response_and_gradient(parameters, data_.omega(), realisation_, value_, gradient_);
  } else {
    structure_.response(parameters, data_.omega(), realisation_, value_);
  }
  if (!rule_.residuals(value_, data_.value(), residual)) return false;
  const double factor = rule_.unit / noise_;
  std::for_each_n(residual, count(), [&](double& each) { each *= factor; });
  if (!jacobian) return true;
  for (const JointLayout::Place& place : layout_.free) {
    const double slope =
        factor * layout_.variable(place).derivative(place.shared ? shared[place.index] : own[place.index]);
    const auto of_parameter = std::span(gradient_).subspan(place.parameter * data_.size(), data_.size());
    std::transform(of_parameter.begin(), of_parameter.end(), column_.begin(),
                   [&](std::complex<double> each) { return slope * each; });
    const std::size_t column = place.shared ? layout_.own.size() + place.index : place.index;
    if (!rule_.derivatives(value_, column_, jacobian + column * count())) return false;
  }
  return true;
}

}  // namespace frac::detail
