// SPDX-License-Identifier: BSD-3-Clause
#include "frequency_problem.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frac::detail {

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

FrequencyProblem::FrequencyProblem(const FrequencyResponseData& given, const Structure& model, const FitOptions& wanted)
    : data(given),
      structure(model),
      options(wanted),
      map(model, wanted.constraints, data_scale(given), wanted.component == Component::magnitude),
      priors(model, wanted.constraints, map),
      rule(residual_rule(given, wanted)),
      residuals(given, model, wanted.realisation, map, rule) {
  // Until the residuals tell: noise of a hundredth of the data, in units of which residuals are.
  residuals.set_priors(priors, 0.01);
}

}  // namespace frac::detail
