// SPDX-License-Identifier: BSD-3-Clause
#include "priors.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frac {

double ParameterPrior::distance(double parameter) const {
  return (relative ? std::log(parameter / value) : parameter - value) / deviation;
}

double ParameterPrior::slope(double parameter) const {
  return 1 / ((relative ? parameter : 1) * deviation);
}

namespace detail {

void check_prior(const std::string& name, const ParameterPrior& prior) {
  const auto refuse = [&](const char* reason) {
    throw std::invalid_argument("prior of parameter '" + name + "': " + reason);
  };
  if (!std::isfinite(prior.value)) refuse("its value must be finite");
  if (!(prior.deviation > 0) || !std::isfinite(prior.deviation)) refuse("its deviation must be positive and finite");
  if (prior.relative && !(prior.value > 0)) refuse("only a positive value has a relative deviation");
}

Priors::Priors(const Structure& structure, std::span<const ParameterConstraint> constraints, const ParameterMap& map) {
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    for (const ParameterConstraint& constraint : constraints) {
      if (constraint.name != structure.parameter_names()[i] || !constraint.prior) continue;
      check_prior(constraint.name, *constraint.prior);
      for (const ParameterMap::Free& free : map.free()) {
        if (free.parameter == i && constraint.prior->relative && free.either_sign)
          throw std::invalid_argument("prior of parameter '" + constraint.name +
                                      "': it may be negative, so it takes no relative deviation");
      }
      entries_.push_back({i, *constraint.prior});
    }
  }
}

double Priors::cost(std::span<const double> parameters) const {
  double sum = 0;
  for (const Entry& entry : entries_) {
    const double distance = entry.prior.distance(parameters[entry.parameter]);
    sum += distance * distance;
  }
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

bool Priors::evaluate(const ParameterMap& map, std::span<const double> theta, double* distance,
                      double* jacobian) const {
  const std::vector<double> parameters = map.to_user(theta);
  const std::vector<ParameterMap::Entry> slopes =
      jacobian ? map.jacobian_entries(parameters) : std::vector<ParameterMap::Entry>{};
  for (std::size_t row = 0; row < entries_.size(); ++row) {
    const auto& [parameter, prior] = entries_[row];
    distance[row] = prior.distance(parameters[parameter]);
    if (!std::isfinite(distance[row])) return false;
    if (!jacobian) continue;
    double* const to = jacobian + row * theta.size();
    for (std::size_t k = 0; k < theta.size(); ++k) to[k] = 0;
    for (const ParameterMap::Entry& each : slopes)
      if (each.parameter == parameter) to[each.free] += prior.slope(parameters[parameter]) * each.derivative;
  }
  return true;
}

}  // namespace detail
}  // namespace frac
