// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/verdict_sentence.hpp"

#include <algorithm>
#include <cmath>

#include "base/counted.hpp"
#include "base/short_text.hpp"

namespace frac::detail {
namespace {

std::string described(const RankedFit& ranked) {
  return "'" + ranked.name + "' (" + counted(ranked.fit.free_parameters, "parameter") + ", rms " +
         four_digits(ranked.fit.rms) + ")";
}

/// What shows that residuals are not noise: their size where it exceeds the noise, else that they follow each other.
std::string how_far_off(const LackOfFit& lack) {
  const std::string correlated = " are correlated by " + four_digits(lack.correlation);
  return lack.misfit > 1
             ? "its residuals are " + four_digits(lack.misfit) + " times the noise, and neighbouring ones" + correlated
             : "its neighbouring residuals" + correlated;
}

std::string list_of_bands(const LackOfFit& lack, const AxisUnit& unit) {
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(lack.misses.size(), 3); ++i) {
    const std::string from = unit.text(lack.misses[i].lower), to = unit.text(lack.misses[i].upper);
    text += (i > 0 ? ", " : "") + (from == to ? from : from + " to " + to);
  }
  return text.empty() ? "" : " (misses at " + text + " " + std::string(unit.name) + ")";
}

/// rms of predictions, which are infinite where the rest of the data does not determine the model.
std::string rms_text(double rms) {
  return std::isfinite(rms) ? four_digits(rms) : "none (what is left does not determine the model)";
}

/// Names the departure evidence where the odds follow from it although evidence has the other sign.
std::string evidence_and_odds(const IdentificationResult& result, bool departing) {
  const bool told_apart = departing && (result.evidence > 0) != (result.departure_evidence > 0);
  return "evidence " + four_digits(result.evidence) +
         (told_apart ? ", that of orders other than whole " + four_digits(result.departure_evidence) : "") + " (odds " +
         four_digits(std::pow(10.0, std::abs(result.log10_odds))) + " to 1 for " +
         (result.log10_odds > 0 ? "the fractional one"
          : told_apart          ? "whole orders"
                                : "the integer-order one") +
         ", had they been equal before)";
}

std::string compared(const IdentificationResult& result, const Comparison& pair, Verdict verdict) {
  const Finalist &f = *result.fractional, &i = *result.integer;
  std::string text = described(pair.fractional.ranked) + " against " + described(pair.integer.ranked) + ", " +
                     evidence_and_odds(result, departure_decides(result, pair, verdict)) + ", predictions to rms " +
                     rms_text(f.prediction_rms) + " against " + rms_text(i.prediction_rms);
  if (!std::isnan(f.extrapolation_rms) && !std::isnan(i.extrapolation_rms)) {
    text += ", half a decade beyond to " + rms_text(f.extrapolation_rms) + " against " + rms_text(i.extrapolation_rms);
  }
  return text;
}

std::string decided_order(const Orders& orders) {
  if (!orders.decided) return "";
  const ParameterEstimate& order = *orders.decided;
  return "; order " + order.name + " = " + four_digits(order.value) + " (95 %: " + four_digits(order.ci95_lower) +
         " to " + four_digits(order.ci95_upper) + ")";
}

std::string model_error_and_difference(const IdentificationResult& result, const AxisUnit& unit) {
  std::string text;
  if (result.model_error) {
    text = "; neither follows the data to within their noise, and what is left is taken for model error";
  }
  if (!std::isnan(result.differ_most)) {
    text += "; outside the data they differ most at " + unit.text(result.differ_most_omega) + " " +
            std::string(unit.name) + ", by " + four_digits(100 * result.differ_most) + " %";
  }
  return text;
}

/// For whoever needs a model all the same.
std::string what_may_be_used(const Comparison& pair) {
  const auto needed = [](const Competitor& each) { return each.ranked.fit.free_parameters; };
  if (!pair.fractional_follows || !pair.integer_follows || needed(pair.fractional) == needed(pair.integer)) return "";
  const Competitor& simpler = needed(pair.fractional) < needed(pair.integer) ? pair.fractional : pair.integer;
  return " Both follow the data, '" + simpler.ranked.name + "' with fewer parameters.";
}

}  // namespace

std::string AxisUnit::text(double at) const {
  return four_digits(factor * at);
}

std::string unfitted(const std::vector<std::string>& rivals) {
  constexpr std::size_t most = 3;
  std::string text = rivals.size() == 1 ? "the rival " : "the rivals ";
  for (std::size_t i = 0; i < std::min(rivals.size(), most); ++i) text += (i > 0 ? ", '" : "'") + rivals[i] + "'";
  if (rivals.size() > most) text += " and " + std::to_string(rivals.size() - most) + " more";
  return text + " could not be fitted";
}

std::string verdict_sentence(const IdentificationResult& result, const Comparison& pair, const Ruling& ruling,
                             const AxisUnit& unit) {
  const std::string rivals = compared(result, pair, ruling.verdict);
  switch (ruling.verdict) {
    case Verdict::fractional_supported:
      return "A fractional order is supported: " + rivals + decided_order(pair.orders) +
             (pair.integer_follows || result.model_error ? "" : "; no integer-order candidate follows the data") +
             model_error_and_difference(result, unit) + ".";
    case Verdict::fractional_not_supported: {
      const LackOfFit& lack = pair.fractional.ranked.lack_of_fit;
      const std::string miss = "; the fractional one misses the data: " + how_far_off(lack) + list_of_bands(lack, unit);
      return "A fractional order is not supported: " + rivals + ruling.reason +
             (pair.fractional_follows || result.model_error ? "" : miss) + model_error_and_difference(result, unit) +
             ".";
    }
    default:
      return "The data do not tell: " + rivals + ruling.reason + "." + what_may_be_used(pair);
  }
}

std::string sentence_without_model(const RankedFit& best, const AxisUnit& unit) {
  return "No candidate describes these data to within their noise: the best is " + described(best) + "; " +
         how_far_off(best.lack_of_fit) + list_of_bands(best.lack_of_fit, unit) + ".";
}

std::string advice(const NextMeasurement& next, double noise, const AxisUnit& unit) {
  const std::string less =
      next.accuracy < noise ? ", " + four_digits(noise / next.accuracy) + " times less than here" : "";
  return " To decide, measure " + counted(next.points, "point") + " from " + unit.text(next.lower) + " to " +
         unit.text(next.upper) + " " + std::string(unit.name) + " with noise of " +
         four_digits(100 * next.relative_accuracy) + " % of the response" + less + " (expected evidence " +
         four_digits(next.expected_evidence) + ").";
}

}  // namespace frac::detail
