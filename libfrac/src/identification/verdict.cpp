// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "identification/data/fit_data.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/curvature_fit.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double supported_evidence = 10;  // posterior odds of 150 to 1
constexpr double refuted_evidence = -4;    // odds of 1 to 7, and cross-validation agrees
constexpr double no_evidence = 2;
constexpr double whole_order = 0.1;    // half width of an interval that tells an order to be whole
constexpr double clearly_worse = 1.5;  // rms of predictions
constexpr std::size_t folds = 5;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// (1 - r)/(1 + r) of the residuals, at most 1: the share of the points that carry news.
double independent_share(const std::vector<double>& residual, std::size_t per_point) {
  const double correlation = std::clamp(autocorrelation(residual, per_point, 1), 0.0, 0.999);
  return (1 - correlation) / (1 + correlation);
}

/// The candidate of a class with the least BIC, among those that follow the data or among all.
std::optional<std::size_t> best_of(const std::vector<Competitor>& competitors, bool fractional, bool adequate) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < competitors.size(); ++i) {
    const RankedFit& ranked = competitors[i].ranked;
    if ((ranked.model_class == ModelClass::fractional) != fractional) continue;
    if (adequate && !ranked.lack_of_fit.adequate) continue;
    if (!std::isfinite(ranked.fit.bic)) continue;
    if (!best || ranked.fit.bic < competitors[*best].ranked.fit.bic) best = i;
  }
  return best;
}

/// What the intervals of a fit say about its orders.
struct Orders {
  bool any_free = false;
  const ParameterEstimate* decided = nullptr;  // the one farthest (in intervals) from every whole number
  bool all_whole = true;                       // each known to be a whole number
};
Orders orders_of(const FitResult& fit, double share) {
  const Structure structure(fit.model);
  Orders orders;
  double farthest = 1;
  // The offset of a fit over time comes after the structure's own.
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const ParameterEstimate& estimate = fit.parameters[i];
    if (structure.parameter_roles()[i] != ParameterRole::order) continue;
    orders.any_free = true;
    const double distance = std::abs(estimate.value - std::round(estimate.value));
    if (estimate.at_bound) {
      orders.all_whole = orders.all_whole && distance < 1e-3;
      continue;
    }
    if (!estimate.fixed && !std::isfinite(estimate.standard_error)) {
      orders.all_whole = false;
      continue;
    }
    const bool whole_above = std::round(estimate.value) > estimate.value;
    const double side = whole_above ? estimate.ci95_upper - estimate.value : estimate.value - estimate.ci95_lower;
    const double half_width = estimate.fixed ? 0 : side / std::sqrt(share);
    const double widths = half_width > 0 ? distance / half_width : (distance > 0 ? 1e300 : 0);
    orders.all_whole = orders.all_whole && widths <= 1 && half_width <= whole_order;
    if (widths > farthest) {
      farthest = widths;
      orders.decided = &estimate;
    }
  }
  return orders;
}

std::string list_of_bands(const LackOfFit& lack, const char* unit) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(lack.misses.size(), 3); ++i) {
    text += (i > 0 ? ", " : "") + number(lack.misses[i].lower) + " to " + number(lack.misses[i].upper);
  }
  return text.empty() ? "" : " (misses at " + text + " " + unit + ")";
}

/// rms of the residuals with which fits to the other blocks predict each block, started from the fit to all.
template <class Data, class Options>
double prediction_rms(const Data& data, const Options& options, const Competitor& competitor) {
  const FitResult& whole = competitor.ranked.fit;
  if (competitor.ranked.model_class == ModelClass::fixed_curve) return whole.rms;
  const std::size_t count = points(data), per_point = residuals_per_point(data, options);
  Options warm = options;
  warm.global_start = false;
  warm.constraints.clear();
  const Structure structure(whole.model);
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const ParameterEstimate& estimate = whole.parameters[i];
    ParameterConstraint constraint{estimate.name, {}, {}, {}, {}};
    for (const ParameterConstraint& own : competitor.ranked.model.constraints) {
      if (own.name == estimate.name) constraint = own;
    }
    constraint.start.reset();
    if (estimate.fixed || estimate.at_bound || !std::isfinite(estimate.value)) {
      constraint = {estimate.name, estimate.value, {}, {}, {}};
      if (!std::isfinite(estimate.value)) return infinity;
    } else {
      constraint.start =
          std::clamp(estimate.value, constraint.lower.value_or(-infinity), constraint.upper.value_or(infinity));
    }
    warm.constraints.push_back(std::move(constraint));
  }
  double square = 0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    const std::size_t first = fold * count / folds, last = (fold + 1) * count / folds;
    try {
      const FitResult fit = curvature_fit(part_of(data, first, last, false), structure, warm);
      if (fit.termination == FitTermination::no_usable_start) return infinity;
      const std::vector<double> residual = weighted_residuals(data, options, fit);
      for (std::size_t i = first * per_point; i < last * per_point; ++i) square += residual[i] * residual[i];
    } catch (const std::invalid_argument&) {
      return infinity;
    }
  }
  return std::isfinite(square) ? std::sqrt(square / static_cast<double>(count * per_point)) : infinity;
}

/// Where within a decade outside the data two fits differ most.
void differ_most(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                 const FitResult& fractional, const FitResult& integer) {
  std::vector<double> omega;
  constexpr int steps = 20;
  for (int i = 1; i <= steps; ++i) {
    const double factor = std::pow(10.0, static_cast<double>(i) / steps);
    omega.push_back(data.omega().front() / factor);
    omega.push_back(data.omega().back() * factor);
  }
  if (!std::holds_alternative<ExactRealisation>(options.realisation)) return;
  const auto a = fitted_response(fractional, options.realisation, omega);
  const auto b = fitted_response(integer, options.realisation, omega);
  double most = -1;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double difference = std::abs(a[i] / b[i] - 1.0);
    if (!(difference > most)) continue;
    most = difference;
    result.differ_most = difference;
    result.differ_most_omega = omega[i];
  }
}
void differ_most(IdentificationResult&, const TimeResponseData&, const TimeFitOptions&, const FitResult&,
                 const FitResult&) {}

const char* axis_unit(const FrequencyResponseData&) {
  return "rad/s";
}
const char* axis_unit(const TimeResponseData&) {
  return "s";
}

/// What shows that residuals are not noise: their size where it exceeds the noise, else that they follow each other.
std::string how_far_off(const LackOfFit& lack) {
  const std::string correlated = " are correlated by " + number(lack.correlation);
  return lack.misfit > 1
             ? "its residuals are " + number(lack.misfit) + " times the noise, and neighbouring ones" + correlated
             : "its neighbouring residuals" + correlated;
}

std::string described(const RankedFit& ranked) {
  return "'" + ranked.name + "' (" + std::to_string(ranked.fit.free_parameters) + " parameters, rms " +
         number(ranked.fit.rms) + ")";
}

std::string odds_text(double evidence) {
  const double log10_odds = std::abs(evidence) / (2 * std::log(10.0));
  return log10_odds > 6 ? "more than a million to 1" : number(std::pow(10.0, log10_odds)) + " to 1";
}

/// Whether all residuals are rounding, which have no correlation.
bool meets_exactly(const RankedFit& ranked) {
  return ranked.lack_of_fit.misfit == 1 && std::isnan(ranked.lack_of_fit.correlation);
}

template <class Data, class Options>
void judge_any(IdentificationResult& result, const Data& data, const Options& options,
               const std::vector<Competitor>& competitors, bool rival_skipped) {
  result.verdict = Verdict::undecided;
  result.evidence = result.log10_odds = result.differ_most = result.differ_most_omega = nan;
  std::optional<std::size_t> fractional = best_of(competitors, true, true);
  std::optional<std::size_t> integer = best_of(competitors, false, true);
  const bool fractional_fits = fractional.has_value(), integer_fits = integer.has_value();
  if (!fractional) fractional = best_of(competitors, true, false);
  if (!integer) integer = best_of(competitors, false, false);
  if (fractional) result.fractional = Finalist{*fractional, competitors[*fractional].ranked.fit.free_parameters, nan};
  if (integer) result.integer = Finalist{*integer, competitors[*integer].ranked.fit.free_parameters, nan};
  if (!fractional_fits && !integer_fits) {
    result.verdict = Verdict::no_adequate_model;
    const RankedFit& best = result.ranking.at(result.chosen);
    result.verdict_sentence = "No candidate describes these data to within their noise: the best is " +
                              described(best) + "; " + how_far_off(best.lack_of_fit) +
                              list_of_bands(best.lack_of_fit, axis_unit(data)) + ".";
    return;
  }
  if (!fractional || !integer) {
    result.verdict_sentence = fractional ? "Only fractional-order candidates could be ranked, so nothing is compared."
                                         : "No fractional-order candidate could be ranked, so nothing is compared.";
    return;
  }

  const Competitor& f = competitors[*fractional];
  const Competitor& i = competitors[*integer];
  const std::size_t per_point = residuals_per_point(data, options);
  const Competitor& better = f.ranked.fit.bic < i.ranked.fit.bic ? f : i;
  const double share = independent_share(better.residual, per_point);
  // n ln cost and k ln n apart, since correlation scales the first.
  const double n = static_cast<double>(better.residual.size());
  const auto parameters = [](const Competitor& each) { return static_cast<double>(each.ranked.fit.free_parameters); };
  const auto likelihood = [&](const Competitor& each) {
    return each.ranked.fit.bic - (parameters(each) + 1) * std::log(n);
  };
  result.evidence =
      share * (likelihood(i) - likelihood(f)) + (parameters(i) - parameters(f)) * std::log(std::max(share * n, 2.0));
  result.log10_odds = result.evidence / (2 * std::log(10.0));
  if (f.ranked.model_class == ModelClass::fractional && i.ranked.model_class == ModelClass::integer_order) {
    differ_most(result, data, options, f.ranked.fit, i.ranked.fit);
  }
  result.fractional->prediction_rms = prediction_rms(data, options, f);
  result.integer->prediction_rms = prediction_rms(data, options, i);
  const double of_fractional = result.fractional->prediction_rms, of_integer = result.integer->prediction_rms;

  const Orders orders = orders_of(f.ranked.fit, share);
  const std::string rivals = described(f.ranked) + " against " + described(i.ranked) + ", evidence " +
                             number(result.evidence) + " (odds " + odds_text(result.evidence) + " for the " +
                             (result.evidence > 0 ? "fractional" : "integer-order") + " one), predictions to rms " +
                             number(of_fractional) + " against " + number(of_integer);
  if (!fractional_fits) {
    result.verdict = Verdict::fractional_not_supported;
    result.verdict_sentence = "A fractional order is not supported: only integer-order candidates follow the data, " +
                              described(i.ranked) + "; the best fractional one, " + described(f.ranked) +
                              ", misses them: " + how_far_off(f.ranked.lack_of_fit) +
                              list_of_bands(f.ranked.lack_of_fit, axis_unit(data)) + ".";
    return;
  }
  const bool decided = orders.decided || !orders.any_free;
  const bool strong = result.evidence > supported_evidence;
  const bool predicts = !integer_fits || !(of_fractional > of_integer);
  if (strong && decided && predicts && !rival_skipped) {
    result.verdict = Verdict::fractional_supported;
    result.verdict_sentence =
        "A fractional order is supported: " + rivals +
        (integer_fits ? "" : "; no integer-order candidate follows the data") +
        (orders.decided ? "; order " + orders.decided->name + " = " + number(orders.decided->value) + " (95 %: " +
                              number(orders.decided->ci95_lower) + " to " + number(orders.decided->ci95_upper) + ")."
                        : ".");
    return;
  }
  if (integer_fits) {
    // Where both meet the data to rounding, the simpler one has done so with less.
    const bool both_exact = meets_exactly(i.ranked) && meets_exactly(f.ranked) && parameters(i) <= parameters(f);
    const bool refuted =
        both_exact || (result.evidence < refuted_evidence && !(of_integer > clearly_worse * of_fractional));
    const bool whole = result.evidence < no_evidence && orders.any_free && orders.all_whole;
    if (refuted || whole) {
      result.verdict = Verdict::fractional_not_supported;
      result.verdict_sentence = "A fractional order is not supported: " + rivals +
                                (whole ? "; every order of the fractional one is a whole number." : ".");
      return;
    }
  }
  const char* reason = ", which is too little";
  if (strong && !decided) reason = ", but no order can be told from a whole number";
  if (strong && decided && !predicts) reason = ", but the fractional one predicts left-out points worse";
  if (strong && decided && predicts && rival_skipped) reason = ", but an integer-order rival could not be fitted";
  result.verdict_sentence = "Undecided: " + rivals + reason + ".";
}

}  // namespace

void judge(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
           const std::vector<Competitor>& competitors, bool rival_skipped) {
  judge_any(result, data, options, competitors, rival_skipped);
}

void judge(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
           const std::vector<Competitor>& competitors, bool rival_skipped) {
  judge_any(result, data, options, competitors, rival_skipped);
}

}  // namespace frac::detail
