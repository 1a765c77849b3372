// SPDX-License-Identifier: BSD-3-Clause
#include "identification/background_advice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/short_text.hpp"
#include "frac/identification/constraints.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/information.hpp"
#include "identification/time_growth.hpp"
#include "identification/time_scout.hpp"
#include "identification/verdict/evidence.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/ruling.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

// Evidence by which a background has to pay for itself.  Poles of a ratio follow a drift and then lose by the price of
// a parameter only, while a motion, of several columns, also takes up the shape of what no candidate describes.
constexpr double drift_is_worth = 3, motion_is_worth = 10;
// Evidence that a verdict keeps against rivals beside a background, as without one: odds of 150 and 1 to 55.
constexpr double kept_by_support = 10, kept_by_refusal = 8;

/// What a record may show beside the response to its input.
struct BackgroundKind {
  std::string_view name, option, finding;
  double is_worth;  // evidence from which it is said
  TimeFitOptions options;
};

std::vector<BackgroundKind> backgrounds_beyond(const TimeFitOptions& options) {
  std::vector<BackgroundKind> result{
      {"a drift", "--trend", "The output seems to drift", drift_is_worth, options},
      {"a start in motion", "--earlier-input", "The record seems to start in motion", motion_is_worth, options}};
  result[0].options.trend = true;
  result[1].options.earlier_input = true;
  return result;
}

/// A candidate beside a background that it was not ranked with.
struct Rival {
  Competitor competitor;
  const BackgroundKind* background;
};

Competitor competitor_of(const TimeResponseData& data, const TimeFitOptions& options, RankedFit ranked) {
  std::vector<double> residual = weighted_residuals(data, options, ranked.fit);
  return {std::move(ranked), std::move(residual)};
}

/// The options with the constraints of a candidate and a start at values of its parameters.
TimeFitOptions started(const TimeFitOptions& options, const RankedFit& ranked, const std::vector<std::string>& names,
                       const std::vector<double>& values) {
  TimeFitOptions result = options;
  result.global_start = false;
  result.constraints.insert(result.constraints.end(), ranked.model.constraints.begin(), ranked.model.constraints.end());
  for (std::size_t i = 0; i < names.size(); ++i) {
    ParameterConstraint& known = constraint_of(result.constraints, names[i]);
    if (!known.fixed)
      known.start = std::clamp(values[i], known.lower.value_or(-infinity), known.upper.value_or(infinity));
  }
  return result;
}

/// @param start  the background and where the search starts
std::optional<Competitor> fitted_beside(const TimeResponseData& data, const TimeFitOptions& start,
                                        RankedFit candidate) {
  candidate.fit = fit(data, Structure(candidate.model.formula), start);
  if (candidate.fit.termination == FitTermination::no_usable_start) return std::nullopt;
  candidate.lack_of_fit = lack_of_fit(data, start, candidate.fit);
  Competitor rival = competitor_of(data, start, std::move(candidate));
  return is_comparable(rival) ? std::optional(std::move(rival)) : std::nullopt;
}

/// The best of a class beside a background, found by quick solves from where they ended without.
std::optional<Competitor> best_beside(const TimeResponseData& data, const TimeFitOptions& background, bool fractional,
                                      const std::vector<RankedFit>& ranking) {
  const auto n = static_cast<double>(points(data));
  std::optional<RankedFit> best;
  TimeFitOptions start;
  double least = infinity;
  for (const RankedFit& ranked : ranking) {
    if ((ranked.model_class == ModelClass::fractional) != fractional || !std::isfinite(ranked.fit.cost)) continue;
    const Structure structure(ranked.model.formula);
    const std::vector<std::string>& names = structure.parameter_names();
    std::vector<double> values;
    for (std::size_t i = 0; i < names.size(); ++i) values.push_back(ranked.fit.parameters[i].value);
    const Scouted found = scouted(data, structure, started(background, ranked, names, values));
    const auto parameters = static_cast<double>(ranked.fit.free_parameters);
    const double value = n * std::log(found.cost / n) + price_of_parameters(parameters, n);
    if (!(value < least)) continue;
    least = value;
    best = ranked;
    start = started(background, ranked, names, found.parameters);
  }
  if (!best) return std::nullopt;
  return fitted_beside(data, start, std::move(*best));
}

bool has_dead_time(const NamedModel& model) {
  const std::vector<ParameterRole> roles = Structure(model.formula).parameter_roles();
  return std::find(roles.begin(), roles.end(), ParameterRole::delay) != roles.end();
}

/// The family that `grown` is the member of, grown anew beside a background: poles that followed the background are
/// then not needed.
std::optional<Competitor> grown_beside(const TimeResponseData& data, const TimeFitOptions& background,
                                       const std::vector<NamedModel>& models, const RankedFit& grown) {
  const bool delayed = has_dead_time(grown.model);
  const auto family = std::find_if(models.begin(), models.end(), [&](const NamedModel& model) {
    return model.rational && model.rational->dead_time == delayed;
  });
  if (family == models.end()) return std::nullopt;
  RankedFit candidate = grown;
  candidate.model = best_member(data, *family, background).models.front();
  candidate.name = candidate.model.name;
  TimeFitOptions start = background;
  start.global_start = false;
  start.constraints = candidate.model.constraints;
  return fitted_beside(data, start, std::move(candidate));
}

double independent_share_of(const Competitor& competitor) {
  return independent_share(autocorrelation(competitor.residual, 1, 1));
}

/// What speaks against the verdict once a background is allowed for; empty where it stands.
std::string objection(const IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
                      const std::vector<Rival>& rivals) {
  const bool supported = result.verdict == Verdict::fractional_supported;
  const Finalist& winner_index = supported ? *result.fractional : *result.integer;
  const Competitor winner = competitor_of(data, options, result.ranking.at(winner_index.index));
  for (const Rival& rival : rivals) {
    const Competitor& other = rival.competitor;
    if (other.is_fractional() == supported) continue;
    const double share = independent_share_of(criterion(other) < criterion(winner) ? other : winner);
    const double evidence =
        supported ? evidence_for(winner, other, share) : -evidence_of_departure({other}, winner, share).evidence;
    const double asked = supported ? kept_by_support : kept_by_refusal;
    if (evidence > asked) continue;
    return "beside " + std::string(rival.background->name) + " (" + std::string(rival.background->option) + ") '" +
           other.ranked.name + "' comes to rms " + four_digits(other.ranked.fit.rms) + ", and evidence of '" +
           winner.ranked.name + "' against " + (supported ? "it" : "orders that depart from whole numbers") + " is " +
           four_digits(evidence) + ", where " + four_digits(asked) + " would decide";
  }
  return {};
}

void withdraw_verdict(IdentificationResult& result, const TimeResponseData& data, const TimeFitOptions& options,
                      const std::vector<Rival>& rivals) {
  if (result.verdict != Verdict::fractional_supported && result.verdict != Verdict::fractional_not_supported) return;
  const std::string doubt = objection(result, data, options, rivals);
  if (doubt.empty()) return;
  result.verdict = Verdict::undecided;
  result.log10_odds = log10_odds(result.evidence, result.verdict);
  result.verdict_sentence = "The data do not tell: " + doubt +
                            ". Of a steady record that starts at rest one would say: " + result.verdict_sentence;
}

/// The comparable candidates of the ranking.
std::vector<Competitor> without_background(const TimeResponseData& data, const TimeFitOptions& options,
                                           const std::vector<RankedFit>& ranking) {
  std::vector<Competitor> result;
  for (const RankedFit& ranked : ranking) {
    Competitor each = competitor_of(data, options, ranked);
    if (is_comparable(each)) result.push_back(std::move(each));
  }
  return result;
}

/// What the rival says that is worth most beyond what its background asks for; empty where none is.  Each is held
/// against whichever of the others is best while its residuals tell the share of the points that carry news.
std::string finding(const std::vector<Competitor>& plain, const std::vector<Rival>& rivals) {
  std::string sentence;
  double most = 0;
  for (const Rival& rival : rivals) {
    const double share = independent_share_of(rival.competitor);
    const auto evidence_against = [&](const Competitor& each) { return evidence_for(rival.competitor, each, share); };
    const Competitor& best = *std::min_element(plain.begin(), plain.end(), [&](const auto& a, const auto& b) {
      return evidence_against(a) < evidence_against(b);
    });
    const double beyond = evidence_against(best) - rival.background->is_worth;
    if (!(beyond > most)) continue;
    most = beyond;
    sentence = " " + std::string(rival.background->finding) + ": with " + std::string(rival.background->option) + " '" +
               rival.competitor.ranked.name + "' describes it better than '" + best.ranked.name +
               "' does without (evidence " + four_digits(evidence_against(best)) + ").";
  }
  return sentence;
}

/// The best of each class beside each background.  Beside a drift the family of the best one grows anew.
std::vector<Rival> rivals_of(const Competitor& plain, const TimeResponseData& data,
                             const std::vector<BackgroundKind>& backgrounds, const std::vector<NamedModel>& models,
                             const std::vector<RankedFit>& ranking) {
  std::vector<Rival> rivals;
  const auto add = [&](std::optional<Competitor> rival, const BackgroundKind& background) {
    if (rival) rivals.push_back({std::move(*rival), &background});
  };
  for (const BackgroundKind& background : backgrounds) {
    for (const bool fractional : {true, false})
      add(best_beside(data, background.options, fractional, ranking), background);
    if (background.options.trend && plain.ranked.from_family)
      add(grown_beside(data, background.options, models, plain.ranked), background);
  }
  return rivals;
}

}  // namespace

void weigh_background(IdentificationResult& result, const TimeResponseData& data, const std::vector<NamedModel>& models,
                      const TimeFitOptions& options) {
  if (options.trend || options.earlier_input) return;
  const std::vector<Competitor> plain = without_background(data, options, result.ranking);
  if (plain.empty()) return;
  const Competitor& best = *std::min_element(plain.begin(), plain.end(),
                                             [](const auto& a, const auto& b) { return criterion(a) < criterion(b); });
  if (meets_exactly(best)) return;
  const std::vector<BackgroundKind> backgrounds = backgrounds_beyond(options);
  const std::vector<Rival> rivals = rivals_of(best, data, backgrounds, models, result.ranking);
  withdraw_verdict(result, data, options, rivals);
  result.verdict_sentence += finding(plain, rivals);
}

}  // namespace frac::detail
