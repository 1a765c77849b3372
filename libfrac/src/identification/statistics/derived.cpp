// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/derived.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <stdexcept>

#include "carried_variance.hpp"
#include "definition.hpp"
#include "frac/identification/statistics.hpp"

namespace frac {

DerivedQuantity::DerivedQuantity(std::string_view definition, std::span<const std::string> parameter_names)
    : name_(detail::split_definition(definition).name),
      text_(detail::split_definition(definition).formula),
      formula_(detail::with_pi(text_)) {
  if (formula_.depends_on_s())
    throw std::invalid_argument("'" + text_ + "' depends on s, so it is no number that parameters tell");
  if (std::find(parameter_names.begin(), parameter_names.end(), name_) != parameter_names.end())
    throw std::invalid_argument("'" + name_ + "' is a parameter; call the quantity by another name");
  std::string known;
  for (const std::string& each : parameter_names) known += (known.empty() ? "" : ", ") + each;
  for (const std::string& name : formula_.parameter_names()) {
    const auto found = std::find(parameter_names.begin(), parameter_names.end(), name);
    if (found == parameter_names.end())
      throw std::invalid_argument("'" + name + "' in '" + text_ + "' is no parameter; known are " + known);
    parameter_.push_back(static_cast<std::size_t>(found - parameter_names.begin()));
  }
}

DerivedEstimate DerivedQuantity::at(std::span<const double> parameters,
                                    const std::vector<std::vector<double>>& covariance, double half_width) const {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> values;
  for (const std::size_t i : parameter_) values.push_back(parameters[i]);
  std::vector<std::complex<double>> gradient(values.size());
  const double value = formula_.response_and_gradient(values, 1.0, ExactRealisation{}, gradient).real();
  std::vector<double> derivative(parameters.size(), 0.0);
  bool is_known = std::isfinite(value);
  for (std::size_t k = 0; k < values.size(); ++k) {
    const std::size_t i = parameter_[k];
    derivative[i] = gradient[k].real();
    // What the quantity does not depend on may have no error.
    is_known = is_known && (derivative[i] == 0 || !std::isnan(covariance[i][i]));
  }
  DerivedEstimate result{name_, text_, std::isfinite(value) ? value : nan, nan, nan, nan};
  if (!is_known) return result;
  result.standard_error = std::sqrt(detail::carried_variance(covariance, derivative));
  result.ci95_lower = value - half_width * result.standard_error;
  result.ci95_upper = value + half_width * result.standard_error;
  return result;
}

std::vector<DerivedEstimate> derived_estimates(const FitResult& result, std::span<const DerivedQuantity> quantities) {
  const double half_width =
      student_t_95(static_cast<double>(result.residuals) - static_cast<double>(result.free_parameters));
  std::vector<double> values;
  for (const ParameterEstimate& each : result.parameters) values.push_back(each.value);
  std::vector<DerivedEstimate> derived;
  for (const DerivedQuantity& each : quantities) derived.push_back(each.at(values, result.covariance, half_width));
  return derived;
}

}  // namespace frac
