// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "frac/identification/constraints.hpp"
#include "frac/parallel_for.hpp"
#include "identification/contained_optimum.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/noise_floor.hpp"
#include "identification/data/physical_properties.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/rational/rational_growth.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/statistics/first_order_likelihood.hpp"
#include "identification/statistics/information.hpp"
#include "identification/statistics/residual_tests.hpp"
#include "identification/time_advice.hpp"
#include "identification/time_noise.hpp"
#include "identification/verdict/assumptions.hpp"
#include "identification/verdict/equivalent_candidates.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/integer_limit.hpp"
#include "identification/verdict/verdict.hpp"

namespace frac {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double simplest_within = 2;  // AICc differences the data cannot tell apart

/// A candidate with the constraints that are its own, and what became of it.
struct Outcome {
  NamedModel model;
  std::optional<FitResult> fit;
  std::string reason;
  bool from_family = false;
  bool refuted = false;  // by the record itself, so that it is no rival any more
  /// What detail::FamilyMembers says of a member of a family.
  double departed = std::numeric_limits<double>::infinity();
  std::size_t relaxations = 0;
  bool approximates = false;
  /// Whether it stands for an unstable member of its family, which follows the data closer and takes its part in the
  /// verdict: that is about orders, whatever is assumed of poles.
  bool stands_in = false;
  std::shared_ptr<Outcome> set_aside = nullptr;  // the other one of the two
  bool passive = false;                          // a sum of passive elements
};

/// A candidate nothing is fitted to, with its weighted residuals.
using ComparedCurve = detail::Competitor;

ComparedCurve compared(const FrequencyResponseData& data, const FixedCurve& curve, const detail::ResidualRule& rule,
                       bool told) {
  if (curve.value.size() != data.size()) {
    throw std::invalid_argument("curve '" + curve.name + "' has " + std::to_string(curve.value.size()) +
                                " values for " + std::to_string(data.size()) + " frequencies");
  }
  std::vector<double> residual = detail::curve_residuals(data, rule, curve.value);
  const detail::Information information =
      detail::information(residual, static_cast<double>(curve.fitted_parameters), rule.unit);
  FitResult result{};
  result.model = curve.name;
  result.cost = information.cost;
  result.rms = information.rms;
  result.relative_rms = information.rms / rule.unit;
  result.max_residual = information.max_residual;
  result.aicc = information.aicc;
  result.bic = information.bic;
  result.termination = FitTermination::converged;
  result.message = "A given curve: compared, not fitted.";
  result.free_parameters = curve.fitted_parameters;
  result.residuals = residual.size();
  result.condition = 1;
  LackOfFit lack = detail::residual_tests(residual, rule.per_point(), data.omega(), curve.fitted_parameters, told,
                                          1e-12 * rule.unit);
  NamedModel model{curve.name, curve.name, ModelClass::fixed_curve, "given curve", {}};
  return {{curve.name, ModelClass::fixed_curve, std::move(result), 0, 0, std::move(model), std::move(lack), false, {}},
          std::move(residual)};
}

/// The simplest of the converged fits that are as good as the best of them; the best of all where none converged.
/// Those that follow the data go before those that do not.
std::size_t chosen_of(const std::vector<RankedFit>& ranking) {
  std::optional<std::size_t> best;
  std::size_t chosen = 0;
  const auto usable = [](const RankedFit& ranked) { return ranked.fit.termination == FitTermination::converged; };
  const bool some_adequate = std::any_of(ranking.begin(), ranking.end(), [&](const RankedFit& ranked) {
    return usable(ranked) && ranked.lack_of_fit.adequate;
  });
  for (std::size_t i = 0; i < ranking.size(); ++i) {
    if (!usable(ranking[i]) || (some_adequate && !ranking[i].lack_of_fit.adequate)) continue;
    if (!best) best = chosen = i;
    if (ranking[i].fit.aicc > ranking[*best].fit.aicc + simplest_within) continue;
    // Of two spellings of one structure the one with a name of its own goes before the member of a family.
    const auto simplicity = [&](std::size_t k) {
      return std::pair(ranking[k].fit.free_parameters, ranking[k].from_family);
    };
    if (simplicity(i) < simplicity(chosen)) chosen = i;
  }
  return chosen;
}

/// AICc rewards members of families that follow the noise, which the verdict has seen to predict worse: where it speaks
/// for the other class, its winner is the one to take, and where it is undecided the finalist of greater evidence, if
/// that follows the data with fewer parameters.
void keep_to_verdict(IdentificationResult& result) {
  if (!result.fractional || !result.integer) return;
  const auto ranked = [&](std::size_t index) -> const RankedFit& { return result.ranking.at(index); };
  if (result.verdict == Verdict::undecided) {
    const Finalist& better = result.evidence > 0 ? *result.fractional : *result.integer;
    const bool simpler = better.parameters < ranked(result.chosen).fit.free_parameters;
    if (simpler && ranked(better.index).lack_of_fit.adequate) result.chosen = better.index;
    return;
  }
  if (result.verdict == Verdict::no_adequate_model) return;
  const bool supported = refuses_whole_orders(result.verdict);
  const bool is_fractional = ranked(result.chosen).model_class == ModelClass::fractional;
  if (is_fractional != supported) result.chosen = (supported ? *result.fractional : *result.integer).index;
}

void take(const detail::FamilyMembers& members, Outcome& outcome) {
  outcome.model = members.models.front();
  outcome.from_family = true;
  outcome.departed = members.departed;
  outcome.relaxations = members.relaxations;
  outcome.approximates = members.approximates;
  outcome.stands_in = members.stands_in;
  outcome.passive = members.passive;
}

/// @param options  in which families grow
/// @param ratios   shared by all families
template <class Data, class Options>
void resolve(const Data& data, const Options& options, detail::RatioGrowths& ratios, Outcome& outcome) {
  const detail::FamilyMembers members = detail::best_member(data, outcome.model, options, ratios);
  take(members, outcome);
  if (!members.set_aside) return;
  outcome.set_aside = std::make_shared<Outcome>();
  take(*members.set_aside, *outcome.set_aside);
}

/// Where the model is the best of the exact laws fitted before that it contains, which draws seldom come upon.
std::optional<std::vector<double>> start_at_contained(const NamedModel& model, std::vector<const Outcome*> fitted) {
  constexpr double rounding = 1e-9;
  std::erase_if(fitted, [](const Outcome* each) { return !each->fit || each->fit->relative_rms > rounding; });
  std::stable_sort(fitted.begin(), fitted.end(),
                   [](const Outcome* a, const Outcome* b) { return a->fit->cost < b->fit->cost; });
  for (const Outcome* simple : fitted) {
    if (auto start = detail::start_from_contained(model, *simple->fit)) return start;
  }
  return std::nullopt;
}

/// The fit of a formula, or of the member of a family that was chosen.
/// @param fitted  models with fewer parameters
template <class Data, class Options>
void fit_formula(const Data& data, Options options, double hopeless, const std::vector<const Outcome*>& fitted,
                 Outcome& outcome) {
  options.global_start = !outcome.from_family;
  const bool is_free = options.constraints.empty();  // else limits of the user's may leave no such place
  const auto& own = outcome.model.constraints;
  options.constraints.insert(options.constraints.end(), own.begin(), own.end());
  const Structure structure(outcome.model.formula);
  const auto start = options.global_start && is_free ? start_at_contained(outcome.model, fitted) : std::nullopt;
  for (std::size_t i = 0; start && i < start->size(); ++i)
    constraint_of(options.constraints, structure.parameter_names()[i]).start = (*start)[i];
  // Intervals that follow the cost decide about orders, which rational models have none of.  Those of the many
  // coefficients of a grown model say nothing of a part of the system.
  const bool rational = outcome.from_family && outcome.model.model_class == ModelClass::integer_order;
  const auto profiled = outcome.from_family ? detail::Profiled::orders : detail::Profiled::all;
  outcome.fit = rational ? detail::curvature_fit(data, structure, options)
                         : detail::fit_in_reach(data, structure, options, hopeless, profiled);
  if (outcome.fit->termination == FitTermination::no_usable_start) {
    // What has no finite response to an input whose output is finite.
    outcome.refuted = !detail::is_response<Data>;
    outcome.reason = outcome.fit->message;
    outcome.fit.reset();
  } else if (!outcome.model.remark.empty()) {
    outcome.fit->message += " " + outcome.model.remark;
  }
}

/// 0 where the formula is none, which its fit will say.
std::size_t parameters_of(const NamedModel& model) {
  try {
    return Structure(model.formula).parameter_names().size();
  } catch (const std::invalid_argument&) {
    return 0;
  }
}

bool has_dead_time(const NamedModel& model) {
  return model.is_family() ? model.rational && model.rational->dead_time
                           : detail::has_dead_time(Structure(model.formula));
}

/// The fit of a candidate.
/// @param growing  options in which families grow
/// @param fitted   outcomes of models with fewer parameters
template <class Data, class Options>
void fit_candidate(const Data& data, const Options& options, const Options& growing, double hopeless,
                   detail::RatioGrowths& ratios, const std::vector<const Outcome*>& fitted, Outcome& outcome) {
  try {
    if constexpr (detail::is_response<Data>) {
      if (options.assumptions.dead_time == false && has_dead_time(outcome.model)) {
        outcome.refuted = true;
        outcome.reason = "it has a dead time, and the system has none";
        return;
      }
    }
    if (outcome.model.is_family()) resolve(data, growing, ratios, outcome);
    fit_formula(data, options, hopeless, fitted, outcome);
    if (outcome.set_aside) fit_formula(data, options, hopeless, fitted, *outcome.set_aside);
  } catch (const std::invalid_argument& error) {
    outcome.reason = error.what();
  }
}

/// Times the best cost beyond which a candidate is no rival, and its intervals tell nothing: evidence of 300, of
/// which correlated residuals may leave a tenth, or ten times where so few residuals give less.
double by_far(std::size_t residuals) {
  return std::clamp(std::exp(300 / static_cast<double>(residuals)), 1.5, 10.0);
}

/// Fits that ended above a structure they contain start from its optimum, simpler ones first.
template <class Data, class Options>
void start_from_contained(const Data& data, const Options& options, std::vector<Outcome>& outcomes) {
  std::vector<Outcome*> fitted;  // families have grown by themselves
  for (Outcome& outcome : outcomes)
    if (outcome.fit && !outcome.from_family) fitted.push_back(&outcome);
  const auto parameters = [](const Outcome* outcome) { return outcome->fit->free_parameters; };
  std::stable_sort(fitted.begin(), fitted.end(),
                   [&](const Outcome* a, const Outcome* b) { return parameters(a) < parameters(b); });
  for (Outcome* rich : fitted) {
    std::vector<const Outcome*> better;
    constexpr double rounding = 1e-9;
    if (rich->fit->relative_rms <= rounding) continue;  // nothing is lower but by rounding
    for (const Outcome* simple : fitted) {
      if (parameters(simple) <= parameters(rich) && simple->fit->cost < rich->fit->cost * (1 - rounding))
        better.push_back(simple);
    }
    std::stable_sort(better.begin(), better.end(),
                     [](const Outcome* a, const Outcome* b) { return a->fit->cost < b->fit->cost; });
    Options of_rich = options;
    const auto& own = rich->model.constraints;
    of_rich.constraints.insert(of_rich.constraints.end(), own.begin(), own.end());
    for (const Outcome* simple : better) {
      if (!(simple->fit->cost < rich->fit->cost * (1 - rounding))) break;
      std::optional<FitResult> fit = detail::fit_from_contained(data, *rich->fit, *simple->fit, of_rich);
      if (fit && fit->cost < rich->fit->cost) rich->fit = std::move(fit);
    }
  }
}

/// The floor of the noise as the residuals of the family of ratios tell it, which follows most data.
/// @param ratios  takes what has grown with that floor
double learned_floor(const FrequencyResponseData& data, const FitOptions& options,
                     std::unique_ptr<detail::RatioGrowths>& ratios) {
  if (options.without_noise || options.component == Component::magnitude || options.component == Component::phase) {
    return 0;
  }
  FitOptions trial = options;
  // Under relative weight a ratio might follow nothing but the noise of what lies below the floor.
  trial.noise_floor = detail::noise_floor(data, options.component);
  constexpr double settled = 0.3;
  constexpr int most_rounds = 3;
  for (int round = 0; round < most_rounds; ++round) {
    const std::vector<std::complex<double>> model = detail::ratio_response(data, trial, *ratios);
    if (model.empty()) break;
    const double before = *trial.noise_floor, floor = detail::noise_floor(data, model, options.component);
    if (std::abs(floor - before) <= settled * before) break;
    trial.noise_floor = floor;
    ratios = std::make_unique<detail::RatioGrowths>();
  }
  return *trial.noise_floor;
}

/// What became of all candidates.
struct FittedCandidates {
  std::vector<detail::Competitor> competitors, passive;
  std::vector<std::string> skipped;         // with the reason
  std::vector<std::string> skipped_rivals;  // names of those of integer order
};

/// @param growing  see fit_candidate()
/// @param ratios   see resolve()
template <class Data, class Options>
FittedCandidates fitted_candidates(const Data& data, const std::vector<NamedModel>& models, const Options& options,
                                   const Options& growing, detail::RatioGrowths& ratios, int threads) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(models.size());
  for (const NamedModel& model : models) outcomes.push_back({model, {}, {}});
  // Families first: presets that miss by far more than they do need no walk beyond their optimum, and no profiles.
  const auto first_preset = std::stable_partition(outcomes.begin(), outcomes.end(),
                                                  [](const Outcome& outcome) { return outcome.model.is_family(); });
  const auto families = static_cast<std::size_t>(first_preset - outcomes.begin());
  double hopeless = std::numeric_limits<double>::infinity();
  parallel_for(families, threads,
               [&](std::size_t i) { fit_candidate(data, options, growing, hopeless, ratios, {}, outcomes[i]); });
  for (std::size_t i = 0; i < families; ++i) {
    for (const Outcome* each = &outcomes[i]; each; each = each->set_aside.get()) {
      if (each->fit) hopeless = std::min(hopeless, by_far(each->fit->residuals) * each->fit->cost);
    }
  }
  // Those of few parameters first: others start also where they are an exact one of these.
  std::map<std::size_t, std::vector<Outcome*>> by_parameters;
  for (std::size_t i = families; i < outcomes.size(); ++i)
    by_parameters[detail::is_response<Data> ? parameters_of(outcomes[i].model) : 0].push_back(&outcomes[i]);
  std::vector<const Outcome*> fitted;
  for (const auto& group : by_parameters) {
    const std::vector<Outcome*>& alike = group.second;
    parallel_for(alike.size(), threads,
                 [&](std::size_t i) { fit_candidate(data, options, growing, hopeless, ratios, fitted, *alike[i]); });
    fitted.insert(fitted.end(), alike.begin(), alike.end());
  }
  std::vector<Outcome> others;
  for (const Outcome& outcome : outcomes) {
    if (outcome.set_aside) others.push_back(*outcome.set_aside);
  }
  outcomes.insert(outcomes.end(), others.begin(), others.end());
  start_from_contained(data, options, outcomes);

  FittedCandidates candidates;
  for (Outcome& outcome : outcomes) {
    if (!outcome.fit) {
      candidates.skipped.push_back(outcome.model.name + ": " + outcome.reason);
      if (outcome.model.model_class != ModelClass::fractional && !outcome.refuted)
        candidates.skipped_rivals.push_back(outcome.model.name);
      continue;
    }
    std::vector<double> residual = detail::weighted_residuals(data, options, *outcome.fit);
    LackOfFit lack = [&] {
      if constexpr (detail::is_response<Data>)
        return lack_of_fit(data, options, *outcome.fit);
      else
        return detail::tests_in_told_noise(data, options, residual, outcome.fit->free_parameters);
    }();
    RankedFit ranked{outcome.model.name, outcome.model.model_class, std::move(*outcome.fit), 0, 0,
                     outcome.model,      std::move(lack),           outcome.from_family,     {}};
    (outcome.passive ? candidates.passive : candidates.competitors)
        .push_back({std::move(ranked), std::move(residual), outcome.departed, outcome.relaxations, outcome.approximates,
                    outcome.stands_in, outcome.passive});
  }
  return candidates;
}

/// The ranking of the candidates and the verdict on it.
template <class Data, class Options>
IdentificationResult ranked(const Data& data, FittedCandidates candidates, const std::vector<ComparedCurve>& curves,
                            const Options& options) {
  IdentificationResult result{};
  result.skipped = std::move(candidates.skipped);
  std::vector<detail::Competitor> competitors = std::move(candidates.competitors);
  detail::merge_equivalent(competitors, std::move(candidates.passive), detail::weighted_size(data, options),
                           [&](const FitResult& one, const FitResult& other) {
                             if constexpr (detail::is_response<Data>)
                               return detail::same_beyond(data, options, one, other);
                             else
                               return true;
                           });
  competitors.insert(competitors.end(), curves.begin(), curves.end());
  if (competitors.empty()) {
    throw NoCandidateFits("no candidate could be fitted; the first: " + result.skipped.front());
  }
  std::stable_sort(competitors.begin(), competitors.end(),
                   [](const auto& a, const auto& b) { return a.ranked.fit.aicc < b.ranked.fit.aicc; });

  const double best = competitors.front().ranked.fit.aicc;
  double total = 0;
  for (detail::Competitor& competitor : competitors) {
    RankedFit& ranked = competitor.ranked;
    ranked.delta_aicc = std::isfinite(best) ? ranked.fit.aicc - best : nan;
    ranked.akaike_weight = std::exp(-ranked.delta_aicc / 2);
    total += ranked.akaike_weight;
  }
  for (detail::Competitor& competitor : competitors) {
    competitor.ranked.akaike_weight /= total;
    result.ranking.push_back(competitor.ranked);
  }
  result.chosen = chosen_of(result.ranking);
  detail::find_integer_limits(competitors, detail::contains);
  detail::judge(result, data, options, competitors, candidates.skipped_rivals);
  keep_to_verdict(result);
  // Over time nothing is assumed, and no sums of elements grow.
  if constexpr (detail::is_response<Data>) {
    detail::keep_to_assumptions(result, data, options, competitors);
    detail::prefer_elements(result, data, options, competitors);
  }
  const RankedFit& chosen = result.ranking.at(result.chosen);
  if (!chosen.model.remark.empty()) result.notes.push_back(chosen.model.remark);
  return result;
}

void require_candidate(std::size_t count) {
  if (count == 0) throw std::invalid_argument("identify needs at least one candidate");
}

/// The correlation of the noise of a record.  The noise is the same for all candidates: it is what the most likely of
/// them in noise of first order leaves, priced for its parameters, and white where its residuals are.
/// @param white  options of fits in white noise
double noise_correlation(const TimeResponseData& data, const TimeFitOptions& white,
                         const std::vector<detail::Competitor>& competitors) {
  const auto count = static_cast<double>(detail::points(data));
  const detail::Competitor* best = nullptr;
  double least = std::numeric_limits<double>::infinity();
  std::vector<double> left;  // by the best one
  for (const detail::Competitor& each : competitors) {
    if (each.ranked.fit.termination != FitTermination::converged || !detail::is_comparable(each)) continue;
    if (detail::meets_exactly(each)) return 0;
    std::vector<double> residual = detail::weighted_residuals(data, white, each.ranked.fit);
    const double value =
        -2 * detail::first_order_likelihood(residual).logarithm + detail::price_of_parameters(each.parameters(), count);
    if (!(value < least)) continue;
    least = value;
    best = &each;
    left = std::move(residual);
  }
  if (!best || detail::tests_in_told_noise(data, white, left, best->ranked.fit.free_parameters).adequate) return 0;
  TimeFitOptions of_best = white;
  const auto& own = best->ranked.model.constraints;
  of_best.constraints.insert(of_best.constraints.end(), own.begin(), own.end());
  return detail::likely_noise_correlation(data, of_best, best->ranked.fit);
}

/// Whether a class was told over time although no ratios in s took part.  Other whole orders than those of a list may
/// describe a record, the more so where the noise is correlated: it hides what a model misses.
bool asks_for_ratios(const IdentificationResult& result, const std::vector<NamedModel>& models) {
  const bool told = result.verdict == Verdict::fractional_supported ||
                    (result.verdict == Verdict::fractional_not_supported && result.noise_correlation > 0);
  return told && std::none_of(models.begin(), models.end(),
                              [](const NamedModel& each) { return each.rational && !each.rational->free_order; });
}

}  // namespace

IdentificationResult identify(const FrequencyResponseData& data, const std::vector<NamedModel>& models,
                              const std::vector<FixedCurve>& curves, const FitOptions& options, int threads) {
  require_candidate(models.size() + curves.size());
  // Refuses weights that do not go with the data once, before every candidate would be skipped for it.
  static_cast<void>(detail::residual_rule(data, options));
  FitOptions told_floor = options;
  auto ratios = std::make_unique<detail::RatioGrowths>();
  if (options.weight == Weight::learned && !options.noise_floor)
    told_floor.noise_floor = learned_floor(data, options, ratios);
  const detail::ResidualRule rule = detail::residual_rule(data, told_floor);
  std::vector<ComparedCurve> residuals;
  residuals.reserve(curves.size());
  const bool told = options.weight == Weight::given || options.weight == Weight::repeats;
  for (const FixedCurve& curve : curves) residuals.push_back(compared(data, curve, rule, told));
  IdentificationResult result =
      ranked(data, fitted_candidates(data, models, told_floor, told_floor, *ratios, threads), residuals, told_floor);
  result.noise_floor = told_floor.noise_floor.value_or(0);
  for (RankedFit& candidate : result.ranking) candidate.fit.noise_floor = result.noise_floor;
  return result;
}

IdentificationResult identify(const TimeResponseData& data, const std::vector<NamedModel>& models,
                              const TimeFitOptions& options, int threads) {
  require_candidate(models.size());
  TimeFitOptions in_noise = detail::in_noise(options, options.noise_correlation);
  const bool is_open = options.noise != RecordNoise::white && options.noise_correlation == 0;
  const auto judged = [&](const std::vector<NamedModel>& candidates) {
    // In each round the candidates are nearer to what they are in this noise.  As long as nobody knows it, families
    // grow where it is the most likely beside each member, or else slow noise would be taken for poles.
    const auto fitted = [&] {
      TimeFitOptions growing = in_noise;
      if (is_open && in_noise.noise_correlation == 0) growing.noise = RecordNoise::coloured;
      detail::RatioGrowths ratios;
      return fitted_candidates(data, candidates, in_noise, growing, ratios, threads);
    };
    FittedCandidates found = fitted();
    constexpr int most_rounds = 3;
    for (int round = 1; round < most_rounds && is_open; ++round) {
      const double r = noise_correlation(data, detail::in_noise(options, 0), found.competitors);
      if (detail::same_correlation(r, in_noise.noise_correlation, static_cast<double>(detail::points(data)))) break;
      in_noise.noise_correlation = r;
      found = fitted();
    }
    IdentificationResult result = ranked(data, std::move(found), {}, in_noise);
    result.noise_correlation = in_noise.noise_correlation;
    return result;
  };
  IdentificationResult result = judged(models);
  if (asks_for_ratios(result, models)) {
    std::vector<NamedModel> more = models;
    more.push_back(find_model("rational"));
    result = judged(more);
    result.notes.emplace_back(
        "Ratios in s were grown beside the candidates given, as a class is told from these data "
        "only beside whole orders of any number of poles.");
  }
  detail::add_background_advice(data, in_noise, result);
  return result;
}

}  // namespace frac
