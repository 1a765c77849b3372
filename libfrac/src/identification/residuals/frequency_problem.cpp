// SPDX-License-Identifier: BSD-3-Clause
#include "frequency_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "identification/data/fit_data.hpp"
#include "identification/data/physical_properties.hpp"

namespace frac::detail {
namespace {

/// Typical magnitudes of the data and the ranges they span.
DataScale data_scale(const FrequencyResponseData& data) {
  double sum = 0, lower = std::numeric_limits<double>::infinity(), upper = 0;
  std::size_t nonzero = 0;
  for (const std::complex<double> value : data.value()) {
    const double magnitude = std::abs(value);
    if (!(magnitude > 0)) continue;
    sum += std::log(magnitude);
    lower = std::min(lower, magnitude);
    upper = std::max(upper, magnitude);
    ++nonzero;
  }
  // Half a decade beyond the data on either side, so that constant data leave room too.
  constexpr double margin = 3;
  const double first = data.omega().front(), last = data.omega().back();
  if (nonzero == 0) return {1, 1 / margin, margin, std::sqrt(first) * std::sqrt(last), first / margin, last * margin};
  return {std::exp(sum / static_cast<double>(nonzero)), lower / margin, upper * margin,
          std::sqrt(first) * std::sqrt(last),           first / margin, last * margin};
}

/// Members of families are stable by their limits; what is searched blindly has to be looked at.
bool searches_stable(const FitOptions& options) {
  return options.assumptions.stable == true && options.global_start;
}

/// Constraints with an upper limit for each delay that has none, where points are so far apart that it is below the
/// default of ParameterConstraint.
std::vector<ParameterConstraint> with_limits_of_spacing(const Structure& structure, const FrequencyResponseData& data,
                                                        std::vector<ParameterConstraint> constraints) {
  const double limit = longest_dead_time(data);
  if (!(limit * data_scale(data).omega_lower < 2 * std::numbers::pi)) return constraints;
  return with_longest_delay(structure, std::move(constraints), limit);
}

}  // namespace

FrequencyProblem::FrequencyProblem(const FrequencyResponseData& given, const Structure& model, const FitOptions& wanted)
    : Problem(model, with_limits_of_spacing(model, given, wanted.constraints), data_scale(given),
              wanted.component == Component::magnitude),
      data(given),
      options(wanted),
      rule(residual_rule(given, wanted)),
      residuals_(given, model, options.realisation, map, rule, searches_stable(options)) {
  unit = rule.unit;
  residuals_.set_priors(priors, expected_noise);
}

FrequencyProblem::FrequencyProblem(const FrequencyResponseData& given, const Structure& model, const FitOptions& wanted,
                                   ByParameters by)
    : Problem(model, by),
      data(given),
      options(wanted),
      rule(residual_rule(given, wanted)),
      residuals_(given, model, options.realisation, map, rule) {
  unit = rule.unit;
}

FrequencyProblem::FrequencyProblem(const FrequencyProblem& like, std::vector<ParameterConstraint> known)
    : Problem(like.structure, std::move(known), like.map.scale(), like.options.component == Component::magnitude),
      data(like.data),
      options(like.options),
      rule(like.rule),
      residuals_(data, structure, options.realisation, map, rule, searches_stable(options)) {
  unit = rule.unit;
  residuals_.set_priors(priors, like.residuals_.prior_weight());
}

std::unique_ptr<Problem> FrequencyProblem::held(std::string_view parameter, double value) const {
  std::vector<ParameterConstraint> known = constraints;
  hold(known, parameter, value);
  return std::unique_ptr<Problem>(new FrequencyProblem(*this, std::move(known)));
}

}  // namespace frac::detail
