// SPDX-License-Identifier: BSD-3-Clause
#include "family_members.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "element_growth.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/statistics/assumption_evidence.hpp"
#include "identification/statistics/information.hpp"
#include "rational_growth.hpp"
#include "rational_model.hpp"
#include "term_growth.hpp"

namespace frac::detail {
namespace {

ResidualRule rule_of(const FrequencyResponseData& data, const FitOptions& options) {
  if (options.component == Component::magnitude || options.component == Component::phase) {
    throw std::invalid_argument("families are grown on the real and the imaginary part, not on the " +
                                std::string(to_string(options.component)) + "; write the model as a formula");
  }
  // Logarithmic residuals are relative ones as long as they are small, and linear in coefficients only so.
  const bool logarithmic = options.weight == Weight::log_complex;
  return logarithmic ? residual_rule(data, options.component, Weight::relative) : residual_rule(data, options);
}

/// Whether a ratio that follows computed data closer than anything is measured came there as approximations do.  Their
/// residuals fall by about the same factor with each pole, since the error of the best ratio of a function with a
/// branch cut is C q^poles (Gonchar, Rakhmanov 1987), down to the rounding of the data, whatever its digits.  At the
/// order of a true ratio they fall at once to that rounding.  Few real poles and dead times are no such approximation.
bool approximates(const RationalProblem& problem, const RationalLadder& ladder) {
  constexpr double below_measurement = 1e-4;  // of the data
  constexpr double at_rounding = 2;           // times the residuals of the chosen member
  constexpr double at_once = 1.5;             // times the fall of any pole before, in logarithms
  const RationalFit& chosen = ladder.fits[ladder.chosen];
  const auto rms = [&](const RationalFit& fit) { return std::sqrt(fit.cost / static_cast<double>(problem.rows())); };
  if (chosen.shape.relaxations() <= few_relaxations || !(rms(chosen) <= below_measurement)) return false;
  double most_before = 0;
  for (std::size_t i = 1; i <= ladder.chosen; ++i) {
    const double fall = std::log(rms(ladder.fits[i - 1]) / rms(ladder.fits[i]));
    if (rms(ladder.fits[i]) <= at_rounding * rms(chosen)) return !(fall > at_once * most_before);
    most_before = std::max(most_before, fall);
  }
  return false;
}

/// The members of a family with poles in one region.
struct Grown {
  FamilyMembers members;
  std::vector<RationalFit> fits;
  [[nodiscard]] const RationalFit& chosen() const { return fits.at(members.chosen); }
};

/// @param component  of the residuals; both over time
Grown grown_family(const RationalProblem& problem, const RationalFamily& family, Component component,
                   RatioGrowths& ratios) {
  const RationalKind kind{family.dead_time, family.free_order};
  Grown grown;
  FamilyMembers& members = grown.members;
  if (family.zeros) {
    grown.fits = {fit_rational(problem, *family.zeros, family.fewest_poles, kind)};
    members.models.push_back(written_out(problem, grown.chosen().shape, component));
    return grown;
  }
  const bool by_default = family == RationalFamily{};
  const RationalLadder ladder = by_default
                                    ? ratios.ladder(problem)
                                    : grow_rational(problem, family.fewest_poles, family.most_poles, kind, ratios);
  for (const RationalFit& fit : ladder.fits) members.models.push_back(written_out(problem, fit.shape, component));
  members.chosen = ladder.chosen;
  if (ladder.fits.empty()) return grown;
  grown.fits = ladder.fits;
  const RationalFit& best = grown.chosen();
  members.exact = ladder.fits.back().cost <= problem.negligible_cost();
  members.open_range = family.most_poles == RationalFamily{}.most_poles;
  if (!family.free_order) {
    members.relaxations = best.shape.relaxations();
    members.approximates = approximates(problem, ladder);
  }
  for (const RationalFit& fit : ladder.fits) {
    if (!fit.shape.searches_order() || !departs(fit.shape.order)) continue;
    members.departed = std::min(members.departed, schwarz(problem, fit) - schwarz(problem, best));
  }
  return grown;
}

/// "0.83 % of the data"
std::string share_of_data(const RationalProblem& problem, const RationalFit& fit) {
  return four_digits(100 * std::sqrt(fit.cost / static_cast<double>(problem.rows()))) + " %";
}

/// The family with stable poles, unless nobody assumes them or the data speak against them.  Where the free family is
/// unstable, its evidence is that against the stable member which the data speak against least: the chosen one may have
/// parameters that follow a smooth error of the measurement, which are no reason against stability.  Where both
/// families were cut, it tells of the number of poles and not of their places: further ones might bring the stable one
/// as close.
/// @param with        makes the problem of the data with poles in a region
/// @param stable      whether the system is, as far as somebody knows
template <class Make>
FamilyMembers rational_members(const Make& with, const RationalFamily& family, Component component,
                               const std::optional<bool>& stable, RatioGrowths& ratios) {
  const RationalProblem anywhere = with(Poles::anywhere);
  if (2 * family.fewest_poles + 2 > anywhere.rows()) {
    throw std::invalid_argument(counted(anywhere.rows(), "residual") + " cannot determine " +
                                counted(family.fewest_poles, "pole") + " and the numerator");
  }
  Grown free;
  if (stable != true) {
    free = grown_family(anywhere, family, component, ratios);
    if (stable == false || free.members.models.empty() || !is_unstable(free.chosen().shape)) return free.members;
  }
  const RationalProblem left = with(Poles::stable);
  Grown held = grown_family(left, family, component, ratios.stable());
  if (stable == true || held.members.models.empty()) return held.members;
  const auto leftover = [&](const RationalFit& fit) {
    const auto rows = static_cast<double>(left.rows());
    return Leftover{std::sqrt(fit.cost / rows), left.correlation(fit.shape),
                    price_of_parameters(static_cast<double>(fit.parameters), rows)};
  };
  const Leftover closest = leftover(free.chosen());
  std::vector<double> against;
  for (const RationalFit& fit : held.fits) against.push_back(evidence_against(leftover(fit), closest, left.rows()));
  const auto least = std::min_element(against.begin(), against.end());
  const RationalFit& defended = held.fits[static_cast<std::size_t>(least - against.begin())];
  const bool refuted = *least > price_of_assumption && !(free.members.is_cut() && held.members.is_cut());
  const std::string closer = share_of_data(left, free.chosen()),
                    of_stable = share_of_data(left, refuted ? defended : held.chosen());
  held.members.stands_in = true;
  FamilyMembers taken = std::move(refuted ? free.members : held.members);
  taken.set_aside = std::make_shared<const FamilyMembers>(std::move(refuted ? held.members : free.members));
  taken.models[taken.chosen].remark =
      refuted ? "The data speak against a stable system: the best stable model of the family leaves " + of_stable +
                    " of the data (rms), this one " + closer + "."
              : "The system is taken to be stable: a model with poles right of the imaginary axis leaves " + closer +
                    " of the data (rms), this one " + of_stable + ".";
  return taken;
}

FamilyMembers term_members(const TermProblem& problem, const TermFamily& family) {
  const TermLadder ladder = grow_terms(problem, family.most_terms);
  FamilyMembers members;
  members.chosen = ladder.chosen;
  const auto value = [&](const TermFit& fit) { return schwarz(problem, fit.cost, fit.parameters); };
  for (const TermFit& fit : ladder.fits) {
    members.models.push_back(written_out(problem, fit.sum));
    const bool any =
        std::any_of(fit.sum.begin(), fit.sum.end(), [](const Term& term) { return !term.held && departs(term.order); });
    if (any) members.departed = std::min(members.departed, value(fit) - value(ladder.fits[ladder.chosen]));
  }
  return members;
}

FamilyMembers element_members(const TermProblem& problem, const ElementFamily& family) {
  const ElementLadder ladder = grow_elements(problem, family.most_elements);
  FamilyMembers members;
  members.passive = true;
  members.exact = !ladder.fits.empty() && (ladder.fits.back().cost <= problem.negligible_cost() ||
                                           ladder.fits[ladder.chosen].sum.size() >= family.most_elements);
  members.chosen = ladder.chosen;
  for (const TermFit& fit : ladder.fits) members.models.push_back(elements_written_out(problem, fit.sum));
  return members;
}

}  // namespace

FamilyMembers family_members(const FrequencyResponseData& data, const NamedModel& model, const FitOptions& options,
                             RatioGrowths& ratios) {
  const ResidualRule rule = rule_of(data, options);
  const auto with = [&](Poles poles) { return RationalProblem(data, rule, poles); };
  FamilyMembers members =
      model.rational ? rational_members(with, *model.rational, options.component, options.assumptions.stable, ratios)
      : model.terms  ? term_members(TermProblem(data, rule), *model.terms)
                     : element_members(TermProblem(data, rule), model.elements.value());
  if (members.models.empty()) {
    throw std::invalid_argument("model '" + model.name + "': too few residuals for any member of this family");
  }
  return members;
}

FamilyMembers family_members(const TimeResponseData& data, const NamedModel& model, const TimeFitOptions& options,
                             RatioGrowths& ratios) {
  const auto refuse = [&model](const char* reason) {
    throw std::invalid_argument("model '" + model.name + "': " + reason);
  };
  if (!model.rational)
    refuse("the family is grown on frequency responses only; over time write the model as a formula");
  if (model.rational->zeros && *model.rational->zeros > model.rational->most_poles)
    refuse("more zeros than poles, so that it has no finite response to a step");
  const auto with = [&](Poles poles) { return RationalProblem(data, options, poles); };
  FamilyMembers members = rational_members(with, *model.rational, Component::both, std::nullopt, ratios);
  if (members.models.empty()) refuse("too few samples for any member of this family");
  return members;
}

std::optional<double> least_rms_of_relaxations(const FrequencyResponseData& data, const FitOptions& options) {
  const ResidualRule rule = rule_of(data, options);
  const TermProblem problem(data, rule);
  if (passive_kind(problem).response != PassiveResponse::immittance) return std::nullopt;
  const double least = std::sqrt(least_cost_of_relaxations(problem) / static_cast<double>(problem.rows()));
  return least > relaxations_follow ? std::optional(least * rule.unit) : std::nullopt;
}

std::vector<std::complex<double>> ratio_response(const FrequencyResponseData& data, const FitOptions& options,
                                                 RatioGrowths& ratios) {
  const RationalProblem problem(data, rule_of(data, options));
  const RationalLadder& ladder = ratios.ladder(problem);
  return ladder.fits.empty() ? std::vector<std::complex<double>>{}
                             : problem.response(ladder.fits.at(ladder.chosen).shape);
}

FamilyMembers chosen_member(FamilyMembers members) {
  const auto best_of = [&](FamilyMembers all) {
    NamedModel& best = all.models.at(all.chosen);
    best.ends_its_family = all.is_cut();
    all.models = {std::move(best)};
    all.chosen = 0;
    return all;
  };
  if (members.set_aside) members.set_aside = std::make_shared<const FamilyMembers>(best_of(*members.set_aside));
  return best_of(std::move(members));
}

}  // namespace frac::detail
