// SPDX-License-Identifier: BSD-3-Clause
#include "preparation.hpp"

#include <algorithm>
#include <stdexcept>

#include "curves_alone.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/search/robust.hpp"
#include "noise_levels.hpp"

namespace frac::detail {
namespace {

/// Standard deviation of a residual of each curve, of the well-behaved ones under a loss.
std::vector<double> noise_of(const std::vector<JointCurve>& curves, const std::vector<ResidualRule>& rules,
                             const Alone& alone, const FitOptions& options) {
  if (options.weight == Weight::given || options.weight == Weight::repeats)
    return std::vector<double>(curves.size(), 1.0);
  std::vector<CurveVariance> told(curves.size(), {0, 0});
  for (std::size_t c = 0; c < curves.size(); ++c) {
    if (!alone[c]) continue;
    const double degrees = static_cast<double>(alone[c]->residuals) - static_cast<double>(alone[c]->free_parameters);
    // An exact fit leaves rounding, of which no less than this is meant.
    const double rounding = 1e-14 * rules[c].unit;
    if (!(degrees > 0)) continue;
    const double spread = alone[c]->loss_scale / tuning_constant(options.loss);
    const double variance = options.loss == Loss::none ? alone[c]->cost / degrees : spread * spread;
    told[c] = {std::max(variance, rounding * rounding), degrees};
  }
  return moderated_deviations(told);
}

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
  result.lead_laws.assign(result.from_curve.begin(), result.from_curve.end());
  return result;
}

}  // namespace

Preparation from_fits_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                            const JointFitOptions& options) {
  JointFitOptions without_priors = options;
  for (ParameterConstraint& each : without_priors.fit.constraints) each.prior = std::nullopt;
  Preparation result{fit_alone(curves, structure, without_priors), {}, {}, {}};
  result.values = start_values(structure, options, result.alone);
  for (std::size_t c = 0; c < curves.size(); ++c)
    result.rules.push_back(
        residual_rule(curves[c].data, result.alone[c] ? settled(options.fit, *result.alone[c]) : options.fit));
  result.noise = noise_of(curves, result.rules, result.alone, options.fit);
  return result;
}

}  // namespace frac::detail
