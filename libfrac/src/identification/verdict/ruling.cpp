// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/ruling.hpp"

#include <algorithm>
#include <cmath>

#include "base/short_text.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/verdict_sentence.hpp"

namespace frac::detail {
namespace {

constexpr double supported_evidence = 10;  // posterior odds of 150 to 1
// Over time a ratio with one pole more, whose price (2 ln n and that of its place) hid it, would take up to that from
// the evidence, and a record spans too few decades of time to outweigh it.
constexpr double supported_over_time = 20;
constexpr double refuted_evidence = -8;  // posterior odds of 1 to 55
// For each real pole and dead time of a ratio beyond few_relaxations more evidence is asked: odds of 3000 to 1.
constexpr double price_of_relaxation = 16;
// Probability that neither finalist is near what made the data, so that evidence for one of them says nothing of its
// class: where all rules of a verdict agree, and where some speak against the evidence.  Chosen on judged files.
constexpr double neither_agreed = 0.05, neither_contradicted = 0.5;
constexpr double worse = 1.05, clearly_worse = 1.5;  // rms of predictions
// rms of extrapolations, for a fractional model: data of a short ladder of poles follow one power over the band and
// bend beyond it, where a power does not.
constexpr double worse_beyond = 1.25;
// A ratio that was fitted without the last half decade and misses it by more than so many times its residuals follows
// the rest without knowing the system.
constexpr double most_of_extrapolation = 100;

/// Also where either is NaN, which stands for predictions that were not made.
bool not_above(double value, double times, double other) {
  return !(value > times * other);
}

/// Real poles and dead times of the integer-order finalist that are charged for.
std::size_t relaxations_beyond_few(const Comparison& pair) {
  return std::max(pair.integer.relaxations, few_relaxations) - few_relaxations;
}

/// The evidence an integer-order finalist has to have against orders that depart.
double evidence_to_refute(const Comparison& pair) {
  return refuted_evidence - price_of_relaxation * static_cast<double>(relaxations_beyond_few(pair));
}

std::string too_little_evidence(const IdentificationResult& result, const Comparison& pair) {
  if (result.evidence > supported_evidence) {
    return ", which over time has to be above " + four_digits(supported_over_time) +
           ", since the price of one pole more may hide it";
  }
  const std::string departing = ", and evidence against orders that depart from whole numbers by " +
                                four_digits(least_departure) + " is " + four_digits(-result.departure_evidence);
  if (result.departure_evidence < refuted_evidence) {
    return departing + ", while a row of " + std::to_string(pair.integer.relaxations) +
           " real poles and dead times, which may approximate another fractional system, asks for " +
           four_digits(-evidence_to_refute(pair));
  }
  const bool whole = result.evidence < refuted_evidence || pair.orders.departure > 0;
  return whole ? departing + " only" : ", which is too little";
}

/// What speaks against the verdict that a fractional order is supported; empty where nothing does.
std::string against_fractional(const IdentificationResult& result, const Comparison& pair,
                               const std::vector<std::string>& skipped_rivals) {
  const Finalist &f = *result.fractional, &i = *result.integer;
  if (!(result.evidence > (pair.over_time ? supported_over_time : supported_evidence))) {
    return too_little_evidence(result, pair);
  }
  if (result.evidence_beside_smooth_error <= supported_evidence) {
    return ", but beside a smooth error such as measurements have it is " +
           four_digits(result.evidence_beside_smooth_error);
  }
  const bool decided = (pair.orders.decided && !pair.orders.all_nearly_whole) || !pair.orders.any_free;
  if (!decided) return ", but no order can be told from a whole number";
  if (pair.rounded && f.parameters > i.parameters) {
    return ", but the values are rounded so coarsely that the fractional one, with more parameters, may follow the "
           "steps";
  }
  const bool predicts = not_above(f.prediction_rms, worse, i.prediction_rms) &&
                        not_above(f.extrapolation_rms, worse_beyond, i.extrapolation_rms);
  if (!predicts) return ", but the fractional one predicts left-out points worse";
  return skipped_rivals.empty() ? "" : ", but " + unfitted(skipped_rivals);
}

/// Why the integer-order finalist may not refute, whatever the evidence; empty where it may.
std::string against_integer_model(const IdentificationResult& result, const Comparison& pair) {
  if (!pair.integer_follows) return ", but the integer-order one does not follow the data";
  if (result.departure_beside_smooth_error > 0) {
    return ", but beside a smooth error such as measurements have a fractional one does better (evidence " +
           four_digits(result.departure_beside_smooth_error) + ")";
  }
  if (pair.rounded && result.integer->parameters > pair.departure.parameters) {
    return ", but the values are rounded so coarsely that the integer-order one, with more parameters, may follow the "
           "steps";
  }
  // Where no fractional family grows, a ratio with more parameters refutes the given fractional models only.
  if (pair.only_integer_grew && result.integer->parameters > result.fractional->parameters) {
    return ", but no fractional family grew beside the integer-order one, which needed more parameters";
  }
  // A ratio with enough poles follows any data.  One that needed all the poles it may have shows no integer order.
  if (pair.integer.ranked.model.ends_its_family) return ", but the integer-order one has as many poles as are tried";
  if (pair.integer.approximates) {
    return ", but the integer-order one, a row of real poles, follows data without noise as an approximation of "
           "another system does";
  }
  return "";
}

/// Why it may not refute although evidence does; empty where it may.
std::string against_integer_predictions(const IdentificationResult& result, const Comparison& pair) {
  const Finalist &f = *result.fractional, &i = *result.integer;
  const double lost = i.extrapolation_rms / pair.integer.ranked.fit.rms;
  if (lost > most_of_extrapolation) {
    return ", but the integer-order one, fitted to the rest, misses half a decade at the ends by " + four_digits(lost) +
           " times its residuals";
  }
  if (!(result.evidence < no_evidence || pair.orders.all_nearly_whole)) {
    return ", but the better one has an order that may be other than whole";
  }
  // A fractional model with whole orders is the integer-order model over again, and may predict as well.
  const double at_most = pair.orders.departure > 0 ? clearly_worse : worse;
  const bool predicts = not_above(i.prediction_rms, at_most, f.prediction_rms) &&
                        not_above(i.extrapolation_rms, clearly_worse, f.extrapolation_rms);
  return predicts ? "" : ", but the integer-order one predicts left-out points worse";
}

/// Whether orders depart and nothing shows of it.
bool does_not_show(const Orders& orders) {
  return orders.any_departs && orders.departure > 0;
}

/// Whether both meet the data to rounding: then the simpler one has done so with less.
bool equally_exact(const IdentificationResult& result, const Comparison& pair) {
  return meets_exactly(pair.integer) && meets_exactly(pair.fractional) &&
         result.integer->parameters <= result.fractional->parameters;
}

}  // namespace

Ruling ruling(const IdentificationResult& result, const Comparison& pair,
              const std::vector<std::string>& skipped_rivals) {
  const std::string fractional_objection = against_fractional(result, pair, skipped_rivals);
  if (fractional_objection.empty()) return {Verdict::fractional_supported, ""};
  const bool exact = equally_exact(result, pair);
  if (!exact && !(result.departure_evidence < evidence_to_refute(pair))) {
    return {Verdict::undecided, fractional_objection};
  }
  std::string integer_objection = against_integer_model(result, pair);
  if (integer_objection.empty() && !exact) integer_objection = against_integer_predictions(result, pair);
  if (!integer_objection.empty()) return {Verdict::undecided, integer_objection};
  return {Verdict::fractional_not_supported,
          does_not_show(pair.orders)  ? "; what is fractional of the fractional one does not show"
          : pair.orders.departure > 0 ? "; every order of the fractional one is whole"
                                      : ""};
}

bool decides(double evidence) {
  return evidence > supported_evidence;
}

bool departure_decides(const IdentificationResult& result, const Comparison& pair, Verdict verdict) {
  const bool refused = verdict == Verdict::fractional_not_supported && !(result.evidence < refuted_evidence);
  return refused || does_not_show(pair.orders) || (pair.orders.any_free && pair.orders.all_nearly_whole);
}

double log10_odds(double evidence, Verdict verdict) {
  const double neither = verdict == Verdict::undecided ? neither_contradicted : neither_agreed;
  const double fractional = 1 / (1 + std::exp(-evidence / 2)), integer = 1 / (1 + std::exp(evidence / 2));
  return std::log10(((1 - neither) * fractional + neither / 2) / ((1 - neither) * integer + neither / 2));
}

double evidence_to_decide(double evidence) {
  return std::max(supported_evidence - evidence, evidence - refuted_evidence);
}

}  // namespace frac::detail
