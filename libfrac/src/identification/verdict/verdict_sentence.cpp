// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/verdict_sentence.hpp"

#include <algorithm>
#include <cmath>

#include "base/counted.hpp"
#include "base/short_text.hpp"

namespace frac::detail {
namespace {

/// What shows that residuals are not noise: their size where it exceeds the noise, else that they follow each other.
std::string how_far_off(const LackOfFit& lack) {
  const std::string correlated = " are correlated by " + four_digits(lack.correlation);
  return lack.misfit > 1
             ? "its residuals are " + four_digits(lack.misfit) + " times the noise, and neighbouring ones" + correlated
             : "its neighbouring residuals" + correlated;
}

std::string odds_against(const DistributionRival& distribution) {
  const double log_odds = log10_odds(distribution.evidence, Verdict::fractional_or_distribution);
  return "odds " + four_digits(std::pow(10.0, std::abs(log_odds))) + " to 1 for the " +
         (log_odds > 0 ? "former" : "latter");
}

std::string note_on_distribution(const DistributionRival& distribution) {
  return "The best distribution of relaxation times has " + counted(distribution.parameters, "parameter") +
         " and leaves rms " + four_digits(100 * distribution.relative_rms) +
         " %; evidence for the fractional one against it is " + four_digits(distribution.evidence) +
         (decides(distribution.evidence) ? "." : ", which above 10 would leave it out.");
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

std::string odds(const IdentificationResult& result, bool departing) {
  return "odds " + four_digits(std::pow(10.0, std::abs(result.log10_odds))) + " to 1 for " +
         (result.log10_odds > 0 ? "the fractional one"
          : departing           ? "whole orders"
                                : "the integer-order one");
}

std::string compared(const IdentificationResult& result, const Comparison& pair, Verdict verdict) {
  return described(pair.fractional.ranked) + " against " + described(pair.integer.ranked) + ", " +
         odds(result, departure_decides(result, pair, verdict));
}

std::string note_on_evidence(const IdentificationResult& result, const Comparison& pair, const Ruling& ruling) {
  // What the odds follow from is named.
  const bool both = departure_decides(result, pair, ruling.verdict);
  return "Evidence is " + four_digits(result.evidence) +
         (both ? ", that of orders other than whole " + four_digits(result.departure_evidence) : "") + ruling.reason +
         "; the odds are those of two classes that were equal before.";
}

std::string note_on_predictions(const IdentificationResult& result) {
  const Finalist &f = *result.fractional, &i = *result.integer;
  std::string text =
      "Left-out points are predicted to rms " + rms_text(f.prediction_rms) + " against " + rms_text(i.prediction_rms);
  if (!std::isnan(f.extrapolation_rms) && !std::isnan(i.extrapolation_rms)) {
    text += ", half a decade beyond to " + rms_text(f.extrapolation_rms) + " against " + rms_text(i.extrapolation_rms);
  }
  return text + ".";
}

std::string decided_order(const Orders& orders) {
  if (!orders.decided) return "";
  const ParameterEstimate& order = *orders.decided;
  return "; order " + order.name + " = " + four_digits(order.value) + " (95 %: " + four_digits(order.ci95_lower) +
         " to " + four_digits(order.ci95_upper) + ")";
}

std::string note_on_misses(const char* which, const RankedFit& ranked, const AxisUnit& unit) {
  return std::string("The ") + which +
         " one does not follow the data to within their noise: " + how_far_off(ranked.lack_of_fit) +
         list_of_bands(ranked.lack_of_fit, unit) + ".";
}

/// For whoever needs a model all the same.
std::string what_may_be_used(const Comparison& pair) {
  const auto needed = [](const Competitor& each) { return each.ranked.fit.free_parameters; };
  if (!pair.fractional_follows || !pair.integer_follows || needed(pair.fractional) == needed(pair.integer)) return "";
  const Competitor& simpler = needed(pair.fractional) < needed(pair.integer) ? pair.fractional : pair.integer;
  return "Both follow the data, '" + simpler.ranked.name + "' with fewer parameters.";
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

std::string described(const RankedFit& ranked) {
  return "'" + ranked.name + "' (" + counted(ranked.fit.free_parameters, "parameter") + ", rms " +
         four_digits(100 * ranked.fit.relative_rms) + " %)";
}

std::string verdict_sentence(const IdentificationResult& result, const Comparison& pair, const Ruling& ruling) {
  const std::string rivals = compared(result, pair, ruling.verdict);
  switch (ruling.verdict) {
    case Verdict::fractional_supported:
      return "A fractional order is supported: " + rivals + decided_order(pair.orders) + ".";
    case Verdict::fractional_or_distribution:
      return (decides(-result.distribution->evidence)
                  ? "A distribution of relaxation times rather than a fractional power: "
                  : "A fractional power or a distribution of relaxation times: ") +
             described(pair.fractional.ranked) + " against " + "lags of spread times (" +
             counted(result.distribution->parameters, "parameter") + ", rms " +
             four_digits(100 * result.distribution->relative_rms) + " %), " + odds_against(*result.distribution) + ".";
    case Verdict::fractional_not_supported:
      return "A fractional order is not supported: " + rivals + ".";
    default:
      return "The data do not tell: " + rivals + ".";
  }
}

std::vector<std::string> verdict_notes(const IdentificationResult& result, const Comparison& pair, const Ruling& ruling,
                                       const AxisUnit& unit) {
  std::vector<std::string> notes{note_on_evidence(result, pair, ruling), note_on_predictions(result)};
  if (result.distribution) notes.push_back(note_on_distribution(*result.distribution));
  if (result.model_error) {
    notes.emplace_back("Neither follows the data to within their noise, and what is left is taken for model error.");
  } else {
    if (!pair.fractional_follows) notes.push_back(note_on_misses("fractional", pair.fractional.ranked, unit));
    if (!pair.integer_follows) notes.push_back(note_on_misses("integer-order", pair.integer.ranked, unit));
  }
  if (ruling.verdict == Verdict::undecided) {
    if (std::string usable = what_may_be_used(pair); !usable.empty()) notes.push_back(std::move(usable));
  } else if (!std::isnan(result.differ_most)) {
    notes.push_back("Outside the data they differ most at " + unit.text(result.differ_most_omega) + " " +
                    std::string(unit.name) + ", by " + four_digits(100 * result.differ_most) + " %.");
  }
  return notes;
}

std::string sentence_without_model(const RankedFit& best) {
  return "No candidate describes these data to within their noise: the best is " + described(best) + ".";
}

std::string note_without_model(const RankedFit& best, const AxisUnit& unit) {
  std::string text = how_far_off(best.lack_of_fit) + list_of_bands(best.lack_of_fit, unit) + ".";
  text.front() = 'I';  // "its"
  return text;
}

std::string advice(const NextMeasurement& next, double noise, const AxisUnit& unit) {
  const std::string less =
      next.accuracy < noise ? ", " + four_digits(noise / next.accuracy) + " times less than here" : "";
  return "To decide, measure " + counted(next.points, "point") + " from " + unit.text(next.lower) + " to " +
         unit.text(next.upper) + " " + std::string(unit.name) + " with noise of " +
         four_digits(100 * next.relative_accuracy) + " % of the response" + less + " (expected evidence " +
         four_digits(next.expected_evidence) + ").";
}

}  // namespace frac::detail
