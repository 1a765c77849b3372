// SPDX-License-Identifier: BSD-3-Clause
#include "identification/background_advice.hpp"

#include <cmath>
#include <limits>

#include "base/short_text.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/time_advice.hpp"
#include "identification/statistics/curvature_fit.hpp"

namespace frac::detail {
namespace {

// Of Schwarz's criterion: odds of 150 to 1, as several are tried.
constexpr double clearly_less = 10;
constexpr std::size_t most_presets = 3;

constexpr double infinity = std::numeric_limits<double>::infinity();

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
