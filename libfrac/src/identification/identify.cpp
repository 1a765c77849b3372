// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>

#include "frac/parallel_for.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/information.hpp"

namespace frac {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double supported_evidence = 10;  // Burnham, Anderson (2002): "essentially no support" for the other
constexpr double simplest_within = 2;      // AICc differences the data cannot tell apart

struct Outcome {
  std::optional<FitResult> fit;
  std::string reason;
};

/// A candidate nothing is fitted to, with its weighted residuals.
struct ComparedCurve {
  RankedFit ranked;
  std::vector<double> residual;
};

ComparedCurve compared(const FrequencyResponseData& data, const FixedCurve& curve, const detail::ResidualRule& rule) {
  if (curve.value.size() != data.size()) {
    throw std::invalid_argument("curve '" + curve.name + "' has " + std::to_string(curve.value.size()) +
                                " values for " + std::to_string(data.size()) + " frequencies");
  }
  std::vector<double> residual = detail::curve_residuals(data, rule, curve.value);
  const detail::Information information = detail::information(residual, curve.fitted_parameters, rule.unit);
  FitResult result{};
  result.model = curve.name;
  result.cost = information.cost;
  result.rms = information.rms;
  result.max_residual = information.max_residual;
  result.aicc = information.aicc;
  result.bic = information.bic;
  result.termination = FitTermination::converged;
  result.message = "A given curve: compared, not fitted.";
  result.free_parameters = curve.fitted_parameters;
  result.residuals = residual.size();
  result.condition = 1;
  return {{curve.name, ModelClass::fixed_curve, std::move(result), 0, 0}, std::move(residual)};
}

/// (1 - r)/(1 + r) of the residuals, at most 1: the share of the points that carry news.
double independent_share(const std::vector<double>& residual, std::size_t per_point) {
  const double correlation = std::clamp(detail::autocorrelation(residual, per_point, 1), 0.0, 0.999);
  return (1 - correlation) / (1 + correlation);
}

const RankedFit* best_of(const std::vector<RankedFit>& ranking, bool fractional) {
  for (const RankedFit& ranked : ranking) {
    if ((ranked.model_class == ModelClass::fractional) == fractional && std::isfinite(ranked.fit.aicc)) return &ranked;
  }
  return nullptr;
}

/// The order farthest (in intervals) from a whole number; none if every interval contains one.
const ParameterEstimate* decided_order(const FitResult& fit, double share) {
  const Structure structure(fit.model);
  const ParameterEstimate* decided = nullptr;
  double farthest = 1;
  // The offset of a fit over time comes after the structure's own.
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const ParameterEstimate& estimate = fit.parameters[i];
    if (structure.parameter_roles()[i] != ParameterRole::order || estimate.at_bound) continue;
    if (!estimate.fixed && !std::isfinite(estimate.standard_error)) continue;
    const double distance = std::abs(estimate.value - std::round(estimate.value));
    const bool whole_above = std::round(estimate.value) > estimate.value;
    const double side = whole_above ? estimate.ci95_upper - estimate.value : estimate.value - estimate.ci95_lower;
    const double half_width = estimate.fixed ? 0 : side / std::sqrt(share);
    const double widths = half_width > 0 ? distance / half_width : (distance > 0 ? 1e300 : 0);
    if (widths > farthest) {
      farthest = widths;
      decided = &estimate;
    }
  }
  return decided;
}

/// The simplest of the converged fits that are as good as the best of them; the best of all where none converged.
std::size_t chosen_of(const std::vector<RankedFit>& ranking) {
  std::optional<std::size_t> best;
  std::size_t chosen = 0;
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    if (ranking[i].fit.termination != FitTermination::converged) continue;
    if (!best) best = chosen = i;
    const bool as_good = !(ranking[i].fit.aicc > ranking[*best].fit.aicc + simplest_within);
    if (as_good && ranking[i].fit.free_parameters < ranking[chosen].fit.free_parameters) chosen = i;
  }
  return chosen;
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// @param share  independent_share() of the residuals of the best
void judge(IdentificationResult& result, double share) {
  const RankedFit* fractional = best_of(result.ranking, true);
  const RankedFit* other = best_of(result.ranking, false);
  result.verdict = Verdict::undecided;
  result.evidence = nan;
  if (!fractional || !other) {
    result.verdict_sentence = fractional ? "Only fractional-order candidates could be ranked, so nothing is compared."
                                         : "No fractional-order candidate could be ranked, so nothing is compared.";
    return;
  }
  result.evidence = share * (other->fit.aicc - fractional->fit.aicc);
  const std::string rivals = "'" + fractional->name + "' (rms " + number(fractional->fit.rms) + ") against '" +
                             other->name + "' (rms " + number(other->fit.rms) + "), evidence " +
                             number(result.evidence);
  if (result.evidence < simplest_within) {
    result.verdict = Verdict::fractional_not_supported;
    result.verdict_sentence = "A fractional order is not supported: " + rivals + ".";
    return;
  }
  const Structure structure(fractional->fit.model);
  const bool has_free_order = std::find(structure.parameter_roles().begin(), structure.parameter_roles().end(),
                                        ParameterRole::order) != structure.parameter_roles().end();
  const ParameterEstimate* order = decided_order(fractional->fit, share);
  if (result.evidence > supported_evidence && (order || !has_free_order)) {
    result.verdict = Verdict::fractional_supported;
    result.verdict_sentence =
        "A fractional order is supported: " + rivals +
        (order ? "; order " + order->name + " = " + number(order->value) + " (95 %: " + number(order->ci95_lower) +
                     " to " + number(order->ci95_upper) + ")."
               : ".");
    return;
  }
  result.verdict_sentence = "Undecided: " + rivals +
                            (result.evidence > supported_evidence ? ", but no order can be told from a whole number."
                                                                  : ", which is too little.");
}

template <class Data, class Options>
IdentificationResult ranked(const Data& data, const std::vector<NamedModel>& models,
                            const std::vector<ComparedCurve>& curves, const Options& options, int threads) {
  if (models.empty() && curves.empty()) throw std::invalid_argument("identify needs at least one candidate");
  std::vector<Outcome> outcomes(models.size());
  parallel_for(models.size(), threads, [&](std::size_t i) {
    Options of_model = options;
    of_model.constraints.insert(of_model.constraints.end(), models[i].constraints.begin(), models[i].constraints.end());
    try {
      outcomes[i].fit = fit(data, Structure(models[i].formula), of_model);
    } catch (const std::invalid_argument& error) {
      outcomes[i].reason = error.what();
    }
  });

  IdentificationResult result{};
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!outcomes[i].fit) {
      result.skipped.push_back(models[i].name + ": " + outcomes[i].reason);
    } else if (outcomes[i].fit->termination == FitTermination::no_usable_start) {
      result.skipped.push_back(models[i].name + ": " + outcomes[i].fit->message);
    } else {
      result.ranking.push_back({models[i].name, models[i].model_class, std::move(*outcomes[i].fit), 0, 0});
    }
  }
  for (const ComparedCurve& curve : curves) result.ranking.push_back(curve.ranked);
  if (result.ranking.empty()) {
    throw NoCandidateFits("no candidate could be fitted; the first: " + result.skipped.front());
  }
  std::stable_sort(result.ranking.begin(), result.ranking.end(),
                   [](const RankedFit& a, const RankedFit& b) { return a.fit.aicc < b.fit.aicc; });

  const double best = result.ranking.front().fit.aicc;
  double total = 0;
  for (RankedFit& ranked : result.ranking) {
    ranked.delta_aicc = std::isfinite(best) ? ranked.fit.aicc - best : nan;
    ranked.akaike_weight = std::exp(-ranked.delta_aicc / 2);
    total += ranked.akaike_weight;
  }
  for (RankedFit& ranked : result.ranking) ranked.akaike_weight /= total;
  result.chosen = chosen_of(result.ranking);
  const RankedFit& front = result.ranking.front();
  const auto curve = std::find_if(curves.begin(), curves.end(), [&](const ComparedCurve& each) {
    return front.model_class == ModelClass::fixed_curve && each.ranked.name == front.name;
  });
  const std::vector<double> residual =
      curve != curves.end() ? curve->residual : detail::weighted_residuals(data, options, front.fit);
  judge(result, independent_share(residual, detail::residuals_per_point(data, options)));
  return result;
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::fractional_supported:
      return "supported";
    case Verdict::fractional_not_supported:
      return "not-supported";
    case Verdict::undecided:
      return "undecided";
  }
  return "unknown";
}

IdentificationResult identify(const FrequencyResponseData& data, const std::vector<NamedModel>& models,
                              const std::vector<FixedCurve>& curves, const FitOptions& options, int threads) {
  // Refuses weights that do not go with the data once, before every candidate would be skipped for it.
  const detail::ResidualRule rule = detail::residual_rule(data, options.component, options.weight);
  std::vector<ComparedCurve> residuals;
  for (const FixedCurve& curve : curves) residuals.push_back(compared(data, curve, rule));
  return ranked(data, models, residuals, options, threads);
}

IdentificationResult identify(const TimeResponseData& data, const std::vector<NamedModel>& models,
                              const TimeFitOptions& options, int threads) {
  return ranked(data, models, {}, options, threads);
}

}  // namespace frac
