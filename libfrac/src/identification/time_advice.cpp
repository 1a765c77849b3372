// SPDX-License-Identifier: BSD-3-Clause
#include "identification/time_advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/short_text.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/statistics/first_order_likelihood.hpp"
#include "model/even_steps.hpp"
#include "records/line_sum.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double clear_odds = 10;  // natural logarithm
// From rest, more samples of the input take longer to run through than the whole fit in steady state.
constexpr std::size_t most_from_rest = 10000;
constexpr std::size_t steps_before = 3;  // see TimeFitOptions::earlier_input

struct Explanation {
  double logarithm = -infinity;  // of the likelihood, less the price of more parameters
  bool earlier_input = false;
};

TimeResponseData under(Hold hold, const TimeResponseData& data) {
  return TimeResponseData(data.time(), data.input(), data.output(), data.sigma(), hold, data.input_at_rest())
      .observed_at(data.observed());
}

double likelihood_of(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& fit) {
  if (fit.termination == FitTermination::no_usable_start) return -infinity;
  const double logarithm = first_order_likelihood(weighted_residuals(data, options, fit)).logarithm;
  return std::isfinite(logarithm) ? logarithm : -infinity;
}

/// The better of the fit without and with an input before the record.
Explanation explained_under(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
                            const FitResult& start, bool is_refitted) {
  Explanation best;
  // Under a wrong hold a fit may end anywhere; the search by lines is quick.
  const TimeFitOptions plain = data.hold() == Hold::band_limited ? options : started_at(options, start);
  try {
    const FitResult again = is_refitted ? start : refit(data, structure, plain);
    best.logarithm = likelihood_of(data, options, again);
    if (options.earlier_input) return best;
    TimeFitOptions in_motion = plain;
    in_motion.earlier_input = true;
    const double price = 0.5 * static_cast<double>(steps_before) * std::log(static_cast<double>(points(data)));
    const double with = likelihood_of(data, in_motion, refit(data, structure, in_motion)) - price;
    if (with > best.logarithm) best = {with, true};
  } catch (const std::invalid_argument&) {
    // A model that has no response from rest, or too few samples for steps before them.
  }
  return best;
}

std::string words(Hold hold, double period) {
  switch (hold) {
    case Hold::zero_order:
      return "held constant between its samples, the input explains the output better";
    case Hold::first_order:
      return "straight between its samples, the input explains the output better";
    case Hold::band_limited:
      break;
  }
  return "the input repeats itself every " + four_digits(period) +
         " s, and as a band-limited signal in its steady state it explains the output better";
}

Remedy remedy_of(Hold hold) {
  switch (hold) {
    case Hold::zero_order:
      return Remedy::hold_zero_order;
    case Hold::first_order:
      return Remedy::hold_first_order;
    case Hold::band_limited:
      break;
  }
  return Remedy::hold_band_limited;
}

// Of Schwarz's criterion: odds of 150 to 1, as several are tried.
constexpr double clearly_less = 10;
constexpr std::size_t most_presets = 3;

struct Better {
  std::string name;
  double bic = infinity;
};

/// The best of the first presets in the ranking with a background, each by a quick solve from where it ended without.
Better best_with(const TimeResponseData& data, const TimeFitOptions& background, double parameters,
                 const IdentificationResult& result) {
  Better best;
  std::size_t tried = 0;
  const auto n = static_cast<double>(points(data));
  for (const RankedFit& ranked : result.ranking) {
    if (ranked.from_family || !(ranked.fit.cost > 0)) continue;
    const Structure structure(ranked.model.formula);
    TimeFitOptions options = background;
    options.constraints = ranked.model.constraints;
    const double cost = scouted_cost(data, structure, started_at(options, ranked.fit));
    const double bic = ranked.fit.bic + n * std::log(cost / ranked.fit.cost) + parameters * std::log(n);
    if (bic < best.bic) best = {ranked.name, bic};
    if (++tried == most_presets) break;
  }
  return best;
}

}  // namespace

void add_advice(const std::vector<Advice>& more, std::vector<Advice>& advice) {
  for (const Advice& each : more) {
    const bool is_there =
        std::any_of(advice.begin(), advice.end(), [&](const Advice& other) { return other.remedy == each.remedy; });
    if (!is_there) advice.push_back(each);
  }
}

std::optional<HoldAdvice> hold_advice(const TimeResponseData& data, const Structure& structure,
                                      const TimeFitOptions& options, const FitResult& result) {
  constexpr double rounding = 1e-9;
  const std::vector<double>& input = data.input();
  const bool input_changes =
      std::any_of(input.begin(), input.end(), [&](double each) { return each != input.front(); });
  if (result.termination == FitTermination::no_usable_start || options.loss != Loss::none || !input_changes ||
      !(result.relative_rms > rounding)) {
    return std::nullopt;
  }
  std::vector<Hold> others;
  double period = 0;
  for (const Hold hold : holds()) {
    if (hold == data.hold()) continue;
    if (hold == Hold::band_limited) {
      constexpr std::size_t fewest = 16;
      if (data.size() < fewest || first_uneven(data.time())) continue;
      const InputPeriod found = input_period(input);
      if (!found.repeats) continue;
      period = found.samples * (data.time().back() - data.time().front()) / static_cast<double>(data.size() - 1);
    } else if (data.size() > most_from_rest) {
      continue;
    }
    others.push_back(hold);
  }
  std::optional<Hold> best_hold;
  Explanation best;
  for (const Hold hold : others) {
    const Explanation other = explained_under(under(hold, data), structure, options, result, false);
    if (other.logarithm > best.logarithm) {
      best = other;
      best_hold = hold;
    }
  }
  if (!best_hold || !(best.logarithm > likelihood_of(data, options, result) + clear_odds)) return std::nullopt;
  const Explanation own = explained_under(data, structure, options, result, true);
  const double odds = best.logarithm - own.logarithm;
  if (!(odds > clear_odds)) return std::nullopt;
  HoldAdvice advice;
  advice.sentence = "The hold " + std::string(to_string(data.hold())) +
                    " cannot be right: " + words(*best_hold, period) + ", with odds of 10^" +
                    std::to_string(static_cast<long>(odds / std::log(10.0))) + " to 1.";
  advice.advice.push_back({remedy_of(*best_hold)});
  if (best.earlier_input) advice.advice.push_back({Remedy::estimate_earlier_input});
  return advice;
}

void add_background_advice(const TimeResponseData& data, const TimeFitOptions& options, IdentificationResult& result) {
  const RankedFit& chosen = result.ranking.at(result.chosen);
  TimeFitOptions of_chosen = options;
  of_chosen.constraints.insert(of_chosen.constraints.end(), chosen.model.constraints.begin(),
                               chosen.model.constraints.end());
  if (const std::optional<HoldAdvice> other =
          hold_advice(data, Structure(chosen.model.formula), of_chosen, chosen.fit)) {
    result.notes.push_back(other->sentence);
    add_advice(other->advice, result.advice);
  }
  if (!chosen.from_family || options.trend || options.earlier_input) return;
  TimeFitOptions trend = options, motion = options;
  trend.trend = motion.earlier_input = true;
  // Steps of the input before the record are three.
  const Better drifting = best_with(data, trend, 1, result), moving = best_with(data, motion, 3, result);
  const bool is_motion = moving.bic < drifting.bic;
  const Better& better = is_motion ? moving : drifting;
  if (!(better.bic < chosen.fit.bic - clearly_less)) return;
  result.notes.push_back((is_motion ? "The record seems to start in motion: with the input before it estimated too"
                                    : "The output seems to drift: with the drift estimated too") +
                         std::string(", '") + better.name + "' describes it better than '" + chosen.name +
                         "' does without (BIC lower by " + four_digits(chosen.fit.bic - better.bic) +
                         "), and the verdict may change.");
  result.advice.push_back({is_motion ? Remedy::estimate_earlier_input : Remedy::estimate_trend});
}

}  // namespace frac::detail
