// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/verdict.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "base/counted.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/verdict/next_measurement.hpp"
#include "identification/verdict/prediction.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/information.hpp"
#include "identification/statistics/residual_tests.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double supported_evidence = 10;  // posterior odds of 150 to 1
// Where the ratio fits no worse, and over time: Schwarz's price leaves out what a prior says of each parameter, which a
// record over few decades of time does not outweigh.
constexpr double supported_by_price = 20;
constexpr double refuted_evidence = -8;  // posterior odds of 1 to 55
constexpr double no_evidence = 2;
// Real poles and dead time that a ratio may have before they count as an approximation of what no candidate is, and the
// evidence asked for each further one: odds of 3000 to 1.
constexpr double few_relaxations = 2, price_of_relaxation = 16;
// Probability that neither finalist is near what made the data, so that evidence for one of them says nothing of its
// class: where all rules of a verdict agree, and where some speak against the evidence.  Chosen on judged files.
constexpr double neither_agreed = 0.05, neither_contradicted = 0.5;
constexpr double nearly_whole = 0.02;  // an order that is known to be so near a whole number counts as one
constexpr double worse = 1.05, clearly_worse = 1.5;  // rms of predictions
// Of extrapolations, for a fractional model: a short ladder follows one power over the band and bends beyond it.
constexpr double worse_beyond = 1.25;
// Times its residuals: a ratio that misses the last half decade by more, when it has not seen it, follows the rest
// without knowing the system.
constexpr double most_of_extrapolation = 100;
constexpr double most_model_error = 0.05;  // of the data

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

double parameters(const RankedFit& ranked) {
  return static_cast<double>(ranked.fit.free_parameters);
}

/// Whether all residuals are rounding, which have no correlation.
bool meets_exactly(const RankedFit& ranked) {
  return ranked.lack_of_fit.misfit == 1 && std::isnan(ranked.lack_of_fit.correlation);
}

/// n ln(cost/n), or what stands for it under noise with heavy tails where that explains the residuals better.  A model
/// is not refuted by a few points that another one goes out of its way for.
double misfit_term(const Competitor& competitor) {
  const RankedFit& ranked = competitor.ranked;
  const double n = static_cast<double>(competitor.residual.size());
  const double normal = ranked.fit.bic - (parameters(ranked) + 1) * std::log(n);
  return meets_exactly(ranked) ? normal : std::min(normal, heavy_tailed_misfit(competitor.residual));
}

double criterion(const Competitor& competitor) {
  const double n = static_cast<double>(competitor.residual.size());
  return misfit_term(competitor) + price_of_parameters(parameters(competitor.ranked), n);
}

/// Whether enough residuals are left over to judge a candidate by.  With more parameters than half of them a model may
/// pass through every point, for which no price is high enough.
bool is_comparable(const Competitor& competitor) {
  const std::size_t n = competitor.residual.size(), k = competitor.ranked.fit.free_parameters;
  return n > k + 2 && n >= 2 * k;
}

/// Chance of residuals like these by noise alone.
double chance_of(const LackOfFit& lack) {
  const double of_size = std::isnan(lack.p_value) ? 1 : lack.p_value;
  return std::min(of_size, std::isnan(lack.correlation_p_value) ? 1 : lack.correlation_p_value);
}

/// Whether a candidate takes part as one that follows the data.  One that fails its test may have failed by accident:
/// a true model does so with a chance of least_chance.  A false one, again, gains evidence E over the true one with a
/// chance of at most exp(-E/2).  So the better of two is set aside only by a chance that is less than both together.
/// @param least  criterion of the best candidate that passes
bool follows(const Competitor& competitor, double least) {
  const LackOfFit& lack = competitor.ranked.lack_of_fit;
  if (lack.adequate) return true;
  const double correlation = std::isnan(lack.correlation) ? 0 : std::clamp(lack.correlation, 0.0, 0.999);
  const double evidence = (least - criterion(competitor)) * (1 - correlation) / (1 + correlation);
  return evidence > 0 && std::isfinite(evidence) && chance_of(lack) > least_chance * std::exp(-evidence / 2);
}

/// The candidate of a class with the least criterion, among those that follow the data or among all.
std::optional<std::size_t> best_of(const std::vector<Competitor>& competitors, bool fractional, bool adequate) {
  double least_of_adequate = infinity;
  for (const Competitor& each : competitors) {
    const double value = each.ranked.lack_of_fit.adequate ? criterion(each) : infinity;
    if (std::isfinite(value)) least_of_adequate = std::min(least_of_adequate, value);
  }
  std::optional<std::size_t> best;
  double least = infinity;
  for (std::size_t i = 0; i < competitors.size(); ++i) {
    const RankedFit& ranked = competitors[i].ranked;
    if ((ranked.model_class == ModelClass::fractional) != fractional || !is_comparable(competitors[i])) continue;
    if (adequate && !follows(competitors[i], least_of_adequate)) continue;
    const double value = criterion(competitors[i]);
    if (!std::isfinite(value) || !(value < least)) continue;
    least = value;
    best = i;
  }
  return best;
}

/// What the intervals of a fit say about its orders.
struct Orders {
  bool any_free = false;
  const ParameterEstimate* decided = nullptr;  // the one farthest (in intervals) from every whole number
  /// By how much evidence falls, to the curvature of the cost, on the way to the nearest order that departs(); 0 where
  /// one does already.
  double departure = infinity;
  bool all_nearly_whole = true;  // each known to be within 0.02 of one, which may lie outside the interval
};
Orders orders_of(const FitResult& fit, double share) {
  const Structure structure(fit.model);
  const auto degrees = static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters);
  Orders orders;
  double farthest = 1;
  // The offset of a fit over time comes after the structure's own.
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const ParameterEstimate& estimate = fit.parameters[i];
    if (structure.parameter_roles()[i] != ParameterRole::order) continue;
    orders.any_free = true;
    const double distance = std::abs(estimate.value - std::round(estimate.value));
    if (departs(estimate.value)) orders.departure = 0;
    if (estimate.at_bound) {
      orders.all_nearly_whole = orders.all_nearly_whole && distance < 1e-3;
      continue;
    }
    if (!estimate.fixed && !std::isfinite(estimate.standard_error)) {
      orders.all_nearly_whole = false;
      orders.departure = 0;
      continue;
    }
    const double above = estimate.ci95_upper - estimate.value, below = estimate.value - estimate.ci95_lower;
    const double side = std::round(estimate.value) > estimate.value ? above : below;
    const double widening = 1 / std::sqrt(share), half_width = estimate.fixed ? 0 : side * widening;
    const double widths = half_width > 0 ? distance / half_width : (distance > 0 ? 1e300 : 0);
    if (!estimate.fixed && degrees > 0) {
      const double widest = std::max(above, below) * widening / student_t_95(degrees);
      const double deviations = std::max(0.0, least_departure - distance) / widest;
      const double fall = static_cast<double>(fit.residuals) * std::log1p(deviations * deviations / degrees);
      orders.departure = std::min(orders.departure, std::isnan(fall) ? 0 : fall);
    }
    orders.all_nearly_whole = orders.all_nearly_whole && distance + half_width <= nearly_whole;
    if (widths > farthest) {
      farthest = widths;
      orders.decided = &estimate;
    }
  }
  // A structure whose fractional order is written into it departs by what it is.
  if (!orders.any_free) orders.departure = 0;
  orders.all_nearly_whole = orders.all_nearly_whole && orders.any_free;
  return orders;
}

std::string list_of_bands(const LackOfFit& lack, const char* unit) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(lack.misses.size(), 3); ++i) {
    text += (i > 0 ? ", " : "") + number(lack.misses[i].lower) + " to " + number(lack.misses[i].upper);
  }
  return text.empty() ? "" : " (misses at " + text + " " + unit + ")";
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
  return "'" + ranked.name + "' (" + counted(ranked.fit.free_parameters, "parameter") + ", rms " +
         number(ranked.fit.rms) + ")";
}

/// Odds of the classes by evidence, where with a probability of `neither` it says nothing.
double log10_odds(double evidence, double neither) {
  const double fractional = 1 / (1 + std::exp(-evidence / 2)), integer = 1 / (1 + std::exp(evidence / 2));
  return std::log10(((1 - neither) * fractional + neither / 2) / ((1 - neither) * integer + neither / 2));
}

/// What a verdict rests on.
struct Comparison {
  const Competitor& fractional;
  const Competitor& integer;
  bool fractional_fits, integer_fits;
  double share;  // of the points that carry news
  Orders orders;
  std::size_t departing_parameters;  // of the candidate that departure evidence is for
  bool only_integer_grew = false;    // the integer-order one is the member of a family, and no fractional family grew
  bool rounded;                      // coarsely_rounded()
  bool price_alone = false;          // over time, and the integer-order one fits no worse
};

/// Whether many values repeat their neighbours': they are rounded so coarsely that the steps are a shape of their own,
/// which a model of many parameters follows.
bool coarsely_rounded(const FrequencyResponseData& data, const FitOptions& options) {
  constexpr double most_repeats = 0.05;
  std::size_t repeats = 0, pairs = 0;
  const auto count = [&](double value, double before) {
    ++pairs;
    repeats += value == before && value != 0 ? 1 : 0;
  };
  for (std::size_t k = 1; k < data.size(); ++k) {
    if (data.omega()[k] == data.omega()[k - 1]) continue;
    if (options.component != Component::imaginary) count(data.value()[k].real(), data.value()[k - 1].real());
    if (options.component != Component::real) count(data.value()[k].imag(), data.value()[k - 1].imag());
  }
  return static_cast<double>(repeats) > most_repeats * static_cast<double>(pairs);
}
bool coarsely_rounded(const TimeResponseData&, const TimeFitOptions&) {
  return false;
}

/// @param share  of the points that carry news
double evidence_for(const Competitor& fractional, const Competitor& integer, double share) {
  const double n = static_cast<double>(fractional.residual.size());
  // Where both meet the data to rounding, what each needed for it is all that tells them apart.
  if (meets_exactly(fractional.ranked) && meets_exactly(integer.ranked)) {
    return price_of_parameters(parameters(integer.ranked), n) - price_of_parameters(parameters(fractional.ranked), n);
  }
  const double news = std::log(std::max(share * n, 2.0)) / std::log(n);
  const auto price = [&](const Competitor& each) { return news * price_of_parameters(parameters(each.ranked), n); };
  return share * (misfit_term(integer) - misfit_term(fractional)) + price(integer) - price(fractional);
}

/// Of the best candidate with an order that departs() against the integer-order finalist.
struct Departure {
  double evidence = -infinity;
  std::size_t parameters = 0;
};
Departure evidence_of_departure(const std::vector<Competitor>& competitors, const Competitor& integer, double share) {
  Departure most;
  for (const Competitor& each : competitors) {
    if (each.ranked.model_class != ModelClass::fractional) continue;
    const double evidence = evidence_for(each, integer, share);
    if (!(evidence > most.evidence)) continue;
    const double falls = std::min(orders_of(each.ranked.fit, share).departure, share * each.departed);
    if (evidence - falls > most.evidence) most = {evidence - falls, each.ranked.fit.free_parameters};
  }
  return most;
}

/// rms of predictions, which are infinite where the rest of the data does not determine the model.
std::string rms_text(double rms) {
  return std::isfinite(rms) ? number(rms) : "none (what is left does not determine the model)";
}

std::string compared(const IdentificationResult& result, const Comparison& pair) {
  const double of_fractional = result.fractional->prediction_rms, of_integer = result.integer->prediction_rms;
  std::string text = described(pair.fractional.ranked) + " against " + described(pair.integer.ranked) + ", evidence " +
                     number(result.evidence) + " (odds " + number(std::pow(10.0, std::abs(result.log10_odds))) +
                     " to 1 for the " + (result.evidence > 0 ? "fractional" : "integer-order") +
                     " one, had they been equal before)" + ", predictions to rms " + rms_text(of_fractional) +
                     " against " + rms_text(of_integer);
  const double beyond_fractional = result.fractional->extrapolation_rms,
               beyond_integer = result.integer->extrapolation_rms;
  if (!std::isnan(beyond_fractional) && !std::isnan(beyond_integer)) {
    text += ", half a decade beyond to " + rms_text(beyond_fractional) + " against " + rms_text(beyond_integer);
  }
  return text;
}

std::string where_they_differ(const IdentificationResult& result) {
  if (std::isnan(result.differ_most)) return "";
  return "; outside the data they differ most at " + number(result.differ_most_omega) + " rad/s, by " +
         number(100 * result.differ_most) + " %";
}

void suggest_next(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                  const Comparison& pair) {
  if (pair.integer.ranked.model_class != ModelClass::integer_order) return;
  const RankedFit& better = result.evidence > 0 ? pair.fractional.ranked : pair.integer.ranked;
  const double noise = std::max(better.lack_of_fit.noise, better.fit.rms);
  const double wanted = std::max(supported_evidence - result.evidence, result.evidence - refuted_evidence);
  result.next = next_measurement(data, options, pair.fractional.ranked.fit, pair.integer.ranked.fit, noise, wanted);
  // Where the two are one model in two spellings, nothing tells them apart.
  if (result.next && !(result.next->expected_evidence > no_evidence)) result.next.reset();
  if (!result.next) return;
  result.verdict_sentence +=
      " To decide, measure " + std::to_string(result.next->points) + (result.next->points == 1 ? " point" : " points") +
      " from " + number(result.next->lower) + " to " + number(result.next->upper) + " rad/s with residuals of " +
      number(result.next->accuracy) + " (expected evidence " + number(result.next->expected_evidence) + ").";
}
void suggest_next(IdentificationResult&, const TimeResponseData&, const TimeFitOptions&, const Comparison&) {}

bool within_model_error(const FrequencyResponseData& data, const FitOptions& options, const FitResult& fit) {
  return fit.rms <= most_model_error * residual_rule(data, options).unit;
}
/// Over time the unit is the rms of the output.
bool within_model_error(const TimeResponseData& data, const TimeFitOptions&, const FitResult& fit) {
  double square = 0;
  for (const std::size_t i : data.observed()) {
    const double weighted = data.output()[i] / (data.sigma().empty() ? 1 : data.sigma()[i]);
    square += weighted * weighted;
  }
  return fit.rms <= most_model_error * std::sqrt(square / static_cast<double>(data.observed().size()));
}

std::string unfitted(const std::vector<std::string>& rivals) {
  constexpr std::size_t most = 3;
  std::string text = rivals.size() == 1 ? "the rival " : "the rivals ";
  for (std::size_t i = 0; i < std::min(rivals.size(), most); ++i) text += (i > 0 ? ", '" : "'") + rivals[i] + "'";
  if (rivals.size() > most) text += " and " + std::to_string(rivals.size() - most) + " more";
  return text + " could not be fitted";
}

/// What would let the skipped rivals take part.
std::string advice_on_skipped(const FrequencyResponseData&, const FitOptions& options) {
  const bool one_number = options.component == Component::magnitude || options.component == Component::phase;
  return one_number ? ": families of ratios are fitted to the real and the imaginary part, not to a magnitude or a "
                      "phase; fit both parts (component both) to have them compared"
                    : "";
}
std::string advice_on_skipped(const TimeResponseData&, const TimeFitOptions&) {
  return "";
}

/// The verdict that the rules of IdentificationResult give, and what was missing where it is undecided.
struct Ruling {
  Verdict verdict;
  std::string reason;
};
Ruling ruling(const IdentificationResult& result, const Comparison& pair,
              const std::vector<std::string>& skipped_rivals) {
  const Orders& orders = pair.orders;
  const auto not_above = [](double value, double times, double other) { return !(value > times * other); };
  const Finalist &f = *result.fractional, &i = *result.integer;
  const bool decided = (orders.decided && !orders.all_nearly_whole) || !orders.any_free;
  const bool strong = result.evidence > (pair.price_alone ? supported_by_price : supported_evidence);
  const bool predicts = !pair.integer_fits || (not_above(f.prediction_rms, worse, i.prediction_rms) &&
                                               not_above(f.extrapolation_rms, worse_beyond, i.extrapolation_rms));
  // What follows the steps of rounded values needs more parameters for it.
  const bool follows_steps = pair.rounded && f.parameters > i.parameters;
  if (pair.fractional_fits && strong && decided && predicts && !follows_steps && skipped_rivals.empty()) {
    return {Verdict::fractional_supported, ""};
  }
  // A ratio with enough poles follows any data.  One that needed all the poles it may have shows no integer order.
  const bool integer_settled = !pair.integer.ranked.model.ends_its_family;
  // Rows of real poles approximate fractional systems, also such as are among no candidates.
  const double relaxations = static_cast<double>(pair.integer.relaxations);
  const double refuted = refuted_evidence - price_of_relaxation * std::max(0.0, relaxations - few_relaxations);
  const bool no_better = result.evidence < no_evidence || orders.all_nearly_whole;
  // Where no fractional family grows, a ratio with more parameters refutes the given fractional models only.
  const bool fair = !pair.only_integer_grew || i.parameters <= f.parameters;
  const bool lost_beyond = i.extrapolation_rms > most_of_extrapolation * pair.integer.ranked.fit.rms;
  const bool on_steps = pair.rounded && i.parameters > pair.departing_parameters;
  if (pair.integer_fits && integer_settled && fair && !on_steps) {
    const auto integer_predicts = [&](double at_most) {
      return not_above(i.prediction_rms, at_most, f.prediction_rms) &&
             not_above(i.extrapolation_rms, clearly_worse, f.extrapolation_rms);
    };
    // Where both meet the data to rounding, the simpler one has done so with less.
    const bool both_exact = meets_exactly(pair.integer.ranked) && meets_exactly(pair.fractional.ranked) &&
                            parameters(pair.integer.ranked) <= parameters(pair.fractional.ranked);
    // A fractional model with whole orders is the integer-order model over again, and may predict as well.
    const bool same_again = orders.departure > 0;
    const bool integer_holds = integer_predicts(same_again ? clearly_worse : worse) || !pair.fractional_fits;
    if (both_exact || (result.departure_evidence < refuted && no_better && integer_holds && !lost_beyond)) {
      return {Verdict::fractional_not_supported, same_again ? "; every order of the fractional one is whole" : ""};
    }
  }
  if (result.departure_evidence < refuted) {
    return {Verdict::undecided,
            on_steps ? ", but the values are rounded so coarsely that the integer-order one, with more parameters, may "
                       "follow the steps"
            : lost_beyond ? ", but the integer-order one, fitted to the rest, misses half a decade at the ends by " +
                                number(i.extrapolation_rms / pair.integer.ranked.fit.rms) + " times its residuals"
            : !no_better ? ", but the better one has an order that may be other than whole"
            : !fair      ? ", but no fractional family grew beside the integer-order one, which needed more parameters"
            : integer_settled ? ", but the integer-order one predicts left-out points worse"
                              : ", but the integer-order one has as many poles as are tried"};
  }
  if (!strong && result.evidence > supported_evidence) {
    return {Verdict::undecided,
            ", all of it the price of the integer-order one's parameters, which over time has to be " +
                number(supported_by_price)};
  }
  if (!strong) {
    const std::string departing = " against orders that depart from whole numbers by " + number(least_departure) +
                                  " is " + number(-result.departure_evidence);
    if (result.departure_evidence < refuted_evidence) {
      return {Verdict::undecided, ", and evidence" + departing + ", while a row of " + number(relaxations) +
                                      " real poles and dead times, which may approximate another fractional system, "
                                      "asks for " +
                                      number(-refuted)};
    }
    const bool whole = result.evidence < refuted_evidence || orders.departure > 0;
    return {Verdict::undecided, whole ? ", and evidence" + departing + " only" : ", which is too little"};
  }
  if (!decided) return {Verdict::undecided, ", but no order can be told from a whole number"};
  if (follows_steps) {
    return {Verdict::undecided,
            ", but the values are rounded so coarsely that the fractional one, with more parameters, may follow the "
            "steps"};
  }
  if (!predicts) return {Verdict::undecided, ", but the fractional one predicts left-out points worse"};
  if (!skipped_rivals.empty()) return {Verdict::undecided, ", but " + unfitted(skipped_rivals)};
  return {Verdict::undecided, ", but only the other one follows the data"};
}

template <class Data, class Options>
void judge_any(IdentificationResult& result, const Data& data, const Options& options,
               const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals) {
  result.verdict = Verdict::undecided;
  result.evidence = result.departure_evidence = result.log10_odds = result.differ_most = result.differ_most_omega = nan;
  if (std::none_of(competitors.begin(), competitors.end(), is_comparable)) {
    result.verdict_sentence =
        "Undecided: too few residuals (" + std::to_string(competitors.front().residual.size()) +
        ") to judge any candidate; at least three more are needed than it has parameters, and twice as many.";
    return;
  }
  std::optional<std::size_t> fractional = best_of(competitors, true, true);
  std::optional<std::size_t> integer = best_of(competitors, false, true);
  const bool fractional_fits = fractional.has_value(), integer_fits = integer.has_value();
  result.model_error = !fractional_fits && !integer_fits;
  if (!fractional) fractional = best_of(competitors, true, false);
  if (!integer) integer = best_of(competitors, false, false);
  const auto finalist = [&](std::size_t index) {
    return Finalist{index, competitors[index].ranked.fit.free_parameters, nan, nan};
  };
  if (fractional) result.fractional = finalist(*fractional);
  if (integer) result.integer = finalist(*integer);
  const auto call_inadequate = [&] {
    result.verdict = Verdict::no_adequate_model;
    const RankedFit& best = result.ranking.at(result.chosen);
    result.verdict_sentence = "No candidate describes these data to within their noise: the best is " +
                              described(best) + "; " + how_far_off(best.lack_of_fit) +
                              list_of_bands(best.lack_of_fit, axis_unit(data)) + ".";
  };
  if (!fractional || !integer) {
    if (result.model_error) return call_inadequate();
    result.verdict_sentence = fractional ? "Only fractional-order candidates could be ranked, so nothing is compared."
                                         : "No fractional-order candidate could be ranked, so nothing is compared.";
    return;
  }

  const Competitor &f = competitors[*fractional], &i = competitors[*integer];
  const std::size_t per_point = residuals_per_point(data, options);
  const bool fractional_is_better = criterion(f) < criterion(i);
  const double share = independent_share((fractional_is_better ? f : i).residual, per_point);
  // Where both are off by model error alone, each is judged as if it followed the data if it comes close.
  Comparison pair{f, i, fractional_fits, integer_fits, share, orders_of(f.ranked.fit, share), 0, false, false};
  pair.only_integer_grew =
      i.ranked.from_family && std::none_of(competitors.begin(), competitors.end(), [](const auto& each) {
        return each.ranked.model_class == ModelClass::fractional && each.ranked.from_family;
      });
  pair.price_alone = std::is_same_v<Data, TimeResponseData> && misfit_term(i) <= misfit_term(f);
  if (result.model_error) {
    pair.fractional_fits = within_model_error(data, options, f.ranked.fit);
    pair.integer_fits = within_model_error(data, options, i.ranked.fit);
    if (!pair.fractional_fits && !pair.integer_fits) return call_inadequate();
  }
  result.evidence = evidence_for(f, i, share);
  const Departure departure = evidence_of_departure(competitors, i, share);
  result.departure_evidence = departure.evidence;
  pair.departing_parameters = departure.parameters;
  pair.rounded = coarsely_rounded(data, options);
  if (f.ranked.model_class == ModelClass::fractional && i.ranked.model_class == ModelClass::integer_order) {
    differ_most(result, data, options, f.ranked.fit, i.ranked.fit);
  }
  const auto blocks = blocks_of(data), ends = end_blocks(data);
  for (const auto& [finalist_of, competitor] : {std::pair(&*result.fractional, &f), std::pair(&*result.integer, &i)}) {
    finalist_of->prediction_rms = prediction_rms(data, options, *competitor, blocks);
    finalist_of->extrapolation_rms = prediction_rms(data, options, *competitor, ends);
  }

  const auto [verdict, reason] = ruling(result, pair, skipped_rivals);
  result.log10_odds =
      log10_odds(result.evidence, verdict == Verdict::undecided ? neither_contradicted : neither_agreed);
  if (result.model_error && verdict == Verdict::undecided) return call_inadequate();
  result.verdict = verdict;
  const std::string rivals = compared(result, pair);
  const std::string model_error =
      result.model_error ? "; neither follows the data to within their noise, and what is left is taken for model error"
                         : "";
  switch (verdict) {
    case Verdict::fractional_supported:
      result.verdict_sentence = "A fractional order is supported: " + rivals;
      if (pair.orders.decided) {
        const ParameterEstimate& order = *pair.orders.decided;
        result.verdict_sentence += "; order " + order.name + " = " + number(order.value) +
                                   " (95 %: " + number(order.ci95_lower) + " to " + number(order.ci95_upper) + ")";
      }
      if (!integer_fits && !result.model_error)
        result.verdict_sentence += "; no integer-order candidate follows the data";
      result.verdict_sentence += model_error + where_they_differ(result) + ".";
      break;
    case Verdict::fractional_not_supported:
      result.verdict_sentence = "A fractional order is not supported: " + rivals + reason;
      if (!fractional_fits && !result.model_error) {
        result.verdict_sentence += "; the fractional one misses the data: " + how_far_off(f.ranked.lack_of_fit) +
                                   list_of_bands(f.ranked.lack_of_fit, axis_unit(data));
      }
      result.verdict_sentence += model_error + where_they_differ(result) + ".";
      break;
    default:
      result.verdict_sentence = "Undecided: " + rivals + reason;
      if (!skipped_rivals.empty()) result.verdict_sentence += advice_on_skipped(data, options);
      result.verdict_sentence += ".";
      suggest_next(result, data, options, pair);
  }
}

}  // namespace

void judge(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals) {
  judge_any(result, data, options, competitors, skipped_rivals);
}

void judge(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals) {
  judge_any(result, data, options, competitors, skipped_rivals);
}

}  // namespace frac::detail
