// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/scene_identification.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "free_search.hpp"
#include "scene_adequacy.hpp"
#include "scene_answer.hpp"
#include "scene_uncertainty.hpp"

namespace backlash {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr frac::detail::Spellings<ContactModel, 3> contact_spellings = {
    {{ContactModel::hard, "hard"}, {ContactModel::compliant, "compliant"}, {ContactModel::automatic, "auto"}}};
constexpr frac::detail::Spellings<FrictionModel, 3> friction_spellings = {
    {{FrictionModel::none, "none"}, {FrictionModel::automatic, "auto"}, {FrictionModel::estimate, "estimate"}}};
// Twice the logarithm of a likelihood ratio that chance exceeds once in a thousand where two parameters may rise from
// 0: it is 0 with probability 1/4, chi squared of one degree with 1/2 and of two with 1/4.
constexpr double significant_friction = 11.8;

// longest: limit of the contact time, s, 0 of hard contacts
std::string contact_text(const SceneIdentification& result, double longest) {
  using frac::detail::short_text;
  if (result.contact.empty()) {
    return longest == 0 ? ""
                        : " The points used are too few for contacts that take time, and the intervals are those of "
                          "hard contacts.";
  }
  const SceneEstimate& time = result.contact.front();
  if (time.fixed) return "";
  if (result.contact_verdict == ContactVerdict::compliant) {
    return " The data tell contacts of " + short_text(time.value) +
           " s from hard ones (twice the log likelihood ratio " + short_text(result.contact_evidence) + ").";
  }
  std::string text = " The data do not tell the contact from a hard one, and the intervals hold for both";
  if (time.ci95_upper < longest) {
    text += ": it takes at most " + short_text(time.ci95_upper) + " s";
    if (std::isfinite(result.contact[1].ci95_lower))
      text += ", by a stiffness of " + short_text(result.contact[1].ci95_lower) + " N/m or more";
  }
  return text + ".";
}

// Whether an interval excludes masses without friction.  A likelihood ratio alone may come from points that one of two
// scenes leaves out.  The frictions may take each other's place, so that their sum is looked at too, which is 0 where
// both are.
bool excludes_none(const detail::FreeMasses& masses, const detail::LocalScene& scene, double least_variance) {
  const detail::SceneUncertainty uncertainty(masses, scene.theta, detail::normal_equations(masses.data(), scene),
                                             {1, least_variance});
  const std::vector<detail::Quantity> of = masses.parameters(scene.theta);
  const detail::Quantity &load = of[detail::first_friction], &drive = of[detail::first_friction + 1];
  detail::Quantity sum = load;
  sum.value += drive.value;
  for (std::size_t k = 0; k < sum.gradient.size(); ++k) sum.gradient[k] += drive.gradient[k];
  const auto excludes_zero = [&](const detail::Quantity& each) { return uncertainty.estimate(each).ci95_lower > 0; };
  return excludes_zero(load) || excludes_zero(drive) || excludes_zero(sum);
}

// What was looked for beside scenes without friction.
struct Friction {
  std::size_t parameters = 0, residuals = 0;  // free ones of a scene with friction, and all of the data
  bool is_found = false;                      // a scene with friction
};

std::string friction_text(const SceneIdentification& result, const Friction& friction) {
  using frac::detail::short_text;
  if (result.friction_verdict == FrictionVerdict::none) return "";
  if (friction.parameters >= friction.residuals) {
    return " The points are too few to know of friction: a scene with it has " + std::to_string(friction.parameters) +
           " parameters that are free, the data have " + std::to_string(friction.residuals) + " residuals.";
  }
  if (!friction.is_found) {
    return " Nowhere that was tried do enough points lie on a motion with friction, so that nothing is known of it.";
  }
  const std::string undecided =
      std::isnan(result.friction_evidence)
          ? " Too few points lie on motions without friction to tell it from none, and the intervals hold for both"
          : " The data do not tell friction from none, and the intervals hold for both";
  if (result.friction.empty()) return undecided + ".";
  const auto& [load, drive] = std::array{result.friction[0], result.friction[1]};
  if (load.fixed && drive.fixed) return "";
  if (result.friction_verdict == FrictionVerdict::present) {
    return " The data tell friction from none: " + short_text(load.value) + " N on mass 1 and " +
           short_text(drive.value) + " N on mass 2 (twice the log likelihood ratio " +
           short_text(result.friction_evidence) + ").";
  }
  std::string text = undecided;
  if (std::isfinite(load.ci95_upper) && std::isfinite(drive.ci95_upper)) {
    text += ": at most " + short_text(load.ci95_upper) + " N on mass 1 and " + short_text(drive.ci95_upper) +
            " N on mass 2";
  }
  return text + ".";
}

// longest: as above
std::string message_of(const SceneIdentification& result, const detail::SceneAnswer& answer, double longest,
                       const Friction& friction, bool has_contacts) {
  detail::MessageParts parts;
  parts.lists_rivals = true;
  parts.ends = !has_contacts;
  parts.of_family =
      has_contacts
          ? contact_text(result, longest) + friction_text(result, friction)
          : " The data do not tell the masses from ones that never touch, so that nothing counts as identified.";
  if (result.friction_verdict == FrictionVerdict::none)
    parts.of_misfit = " Dry friction, which was left out, may be why.";
  return detail::message_of(answer, result.parameters, parts);
}

SceneIdentification nothing_found(const detail::KnownScene& known) {
  SceneIdentification result{};
  result.termination = frac::FitTermination::no_usable_start;
  const bool is_given =
      std::all_of(known.fixed.begin(), known.fixed.end(), [](const auto& value) { return value.has_value(); });
  result.message =
      is_given
          ? "No point lies on a steady motion of the given scene: it misses the data, unless it is irregular at all "
            "of them."
          : "No scene within the limits has steady motions at as many points as there are free parameters.";
  result.cost = result.rms = result.max_residual = result.condition = nan;
  for (std::size_t k = 0; k < 4; ++k) {
    result.parameters[k] = {std::string(detail::scene_names[k]), "",    nan,  nan, nan, nan,
                            known.fixed[k].has_value(),          false, false};
    result.covariance[k].fill(nan);
  }
  for (SceneEstimate& combination : result.combinations)
    combination = {"", "", nan, nan, nan, nan, false, false, false};
  return result;
}

}  // namespace

std::string_view to_string(PointStatus status) {
  switch (status) {
    case PointStatus::used:
      return "used";
    case PointStatus::off_branch:
      return "off-branch";
    case PointStatus::irregular:
      return "irregular";
  }
  return "unknown";
}

std::string SceneIdentification::summary() const {
  return detail::summary_of(parameters, message);
}

TwoMassSystem SceneIdentification::system() const {
  return {parameters[0].value, parameters[1].value, parameters[2].value, parameters[3].value};
}

std::optional<CompliantContact> SceneIdentification::compliant_contact() const {
  if (contact.empty() || !(contact[0].value > 0) || !std::isfinite(contact[1].value)) return std::nullopt;
  return CompliantContact(contact[1].value, contact[2].value);
}

std::string_view to_string(ContactVerdict verdict) {
  switch (verdict) {
    case ContactVerdict::hard:
      return "hard";
    case ContactVerdict::compliant:
      return "compliant";
    case ContactVerdict::undecided:
      break;
  }
  return "undecided";
}

std::string_view to_string(FrictionVerdict verdict) {
  switch (verdict) {
    case FrictionVerdict::none:
      return "none";
    case FrictionVerdict::present:
      return "present";
    case FrictionVerdict::undecided:
      break;
  }
  return "undecided";
}

std::string_view to_string(FrictionModel model) {
  return frac::detail::spelling(friction_spellings, model);
}

std::span<const FrictionModel> friction_models() {
  static constexpr auto all = frac::detail::enumerators(friction_spellings);
  return all;
}

FrictionModel friction_model_from_string(std::string_view text) {
  return frac::detail::from_spelling(friction_spellings, "friction", text);
}

std::string_view to_string(ContactModel model) {
  return frac::detail::spelling(contact_spellings, model);
}

std::span<const ContactModel> contact_models() {
  static constexpr auto all = frac::detail::enumerators(contact_spellings);
  return all;
}

ContactModel contact_model_from_string(std::string_view text) {
  return frac::detail::from_spelling(contact_spellings, "contact", text);
}

SceneIdentification identify_scene(const std::vector<MeasuredDescribingFunction>& curves,
                                   const SceneIdentificationOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  detail::check_curves(curves, options);
  const detail::SceneData data = detail::scene_data(curves, options);
  const detail::KnownScene rubbing = detail::known_scene(data, options);
  detail::KnownScene known = detail::frictionless(rubbing);
  const detail::KnownScene hard = detail::with_hard_contacts(known);
  detail::require_residuals(data, hard.bounds.free_count());
  const std::vector<double> jumps = detail::products_from_jumps(curves);
  detail::SceneSearch found = detail::search_scene(data, hard, jumps, options.threads);

  ContactVerdict contact_verdict =
      options.contact == ContactModel::hard ? ContactVerdict::hard : ContactVerdict::undecided;
  double contact_evidence = nan, friction_evidence = nan;
  const bool takes_time = known.bounds.upper[4] > 0, rubs = detail::has_friction(rubbing.bounds);
  const double longest = known.bounds.upper[4] * data.time_unit;
  if (takes_time) {
    detail::WiderSearch freed = detail::search_contact(data, known, found, options.threads);
    if (freed.scenes.best.usable || !found.best.usable) {
      found = std::move(freed.scenes);
      contact_evidence = freed.evidence;
    } else {
      // Hard contacts then, of which nothing is stated.
      known = hard;
    }
  }
  FrictionVerdict friction_verdict = rubs ? FrictionVerdict::undecided : FrictionVerdict::none;
  const detail::FreeMasses rubbing_masses(data, rubbing);
  detail::UndecidedScenes undecided{&rubbing_masses, {}};  // with friction that the data do not tell from none
  Friction friction{rubbing.bounds.free_count(), data.points.size() * data.residuals_per_point()};
  if (rubs && friction.residuals > friction.parameters) {
    detail::WiderSearch rubbed = detail::search_friction(data, rubbing, known, found, options.threads);
    friction.is_found = rubbed.scenes.best.usable;
    if (friction.is_found) {
      friction_evidence = rubbed.evidence;
      const bool is_told = rubbed.evidence > significant_friction &&
                           excludes_none(rubbing_masses, rubbed.scenes.best, options.sigma_is_measured ? 1 : 0);
      if (is_told) friction_verdict = FrictionVerdict::present;
      // A limit of friction that is given is one of the scene.
      const bool is_given = std::any_of(options.constraints.begin(), options.constraints.end(),
                                        [](const auto& each) { return each.name.starts_with("friction"); });
      if (is_told || is_given || options.friction == FrictionModel::estimate) {
        found = std::move(rubbed.scenes);
        known = rubbing;
      } else {
        undecided.scenes = std::move(rubbed.scenes.rivals);
        undecided.scenes.push_back(std::move(rubbed.scenes.best));
      }
    }
  }
  SceneIdentification result = nothing_found(known);
  result.starts = found.starts;
  result.starts_at_best = found.starts_at_best;
  result.contact_verdict = contact_verdict;
  result.contact_evidence = contact_evidence;
  result.friction_verdict = friction_verdict;
  result.friction_evidence = friction_evidence;
  if (found.best.usable) {
    const detail::FreeMasses masses(data, known);
    detail::SceneAnswer answer = detail::answer_of(masses, found, options.sigma_is_measured, undecided);
    const std::size_t free_count = masses.free_count();
    const bool has_contacts = detail::tells_contacts(data, found.best.choices, free_count, answer.least_variance);
    detail::FreeMasses::Estimates estimates = detail::FreeMasses::sorted(answer.estimates);
    if (!estimates.contact.empty()) {
      // A likelihood ratio alone may come from points that one of the two leaves out.
      const SceneEstimate& time = estimates.contact.front();
      const bool is_told =
          contact_evidence > detail::significant * detail::significant && (time.fixed || time.ci95_lower > 0);
      result.contact_verdict = is_told ? ContactVerdict::compliant : ContactVerdict::undecided;
    }
    // At a limit of one parameter the intervals of the others hold for a scene that has it there.
    const bool is_contact_at_limit =
        estimates.contact.empty() ? takes_time
                                  : estimates.contact.front().at_bound || (options.contact == ContactModel::compliant &&
                                                                           !(estimates.contact.front().value > 0));
    // Without a scene that has friction nothing is known of what it would change.
    const bool is_friction_unknown = rubs && !friction.is_found;
    const auto any_at_bound = [](const auto& of) {
      return std::any_of(of.begin(), of.end(), [](const SceneEstimate& estimate) { return estimate.at_bound; });
    };
    const bool at_limit = is_contact_at_limit || is_friction_unknown || any_at_bound(estimates.friction) ||
                          any_at_bound(estimates.parameters);
    if (!answer.misfits.empty() || !answer.converged || at_limit || !has_contacts) {
      detail::take_back(answer.estimates);
      estimates = detail::FreeMasses::sorted(answer.estimates);
    }
    result.parameters = std::move(estimates.parameters);
    result.combinations = std::move(estimates.combinations);
    result.contact = std::move(estimates.contact);
    result.friction = std::move(estimates.friction);
    detail::fill_in(answer, found, result);
    for (std::size_t k = 0; k < result.covariance.size(); ++k)
      std::copy_n(answer.covariance[k].begin(), result.covariance[k].size(), result.covariance[k].begin());
    result.free_directions = answer.free_directions;
    for (const detail::LocalScene& rival : answer.rivals) {
      const std::vector<detail::Quantity> values = masses.parameters(rival.theta);
      result.rivals.push_back({{values[0].value, values[1].value, values[2].value, values[3].value},
                               values[4].value,
                               {values[5].value, values[6].value},
                               std::exp(0.5 * (rival.deviance - found.best.deviance))});
    }
    result.message = message_of(result, answer, longest, friction, has_contacts);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace backlash
