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

// What the search tells of friction.
struct FrictionFinding {
  FrictionVerdict verdict = FrictionVerdict::none;
  double evidence = nan;
  std::size_t parameters = 0, residuals = 0;  // free ones of a scene with friction, and all of the data
  bool is_found = false;                      // a scene with friction
};

// What is known after each search, which frees more of the scene.
struct Findings {
  detail::KnownScene known;
  detail::SceneSearch search;
  double contact_evidence = nan;
  FrictionFinding friction = {};
  detail::UndecidedScenes undecided = {};  // with friction that the data do not tell from none
};

std::string friction_text(const SceneIdentification& result, const FrictionFinding& friction) {
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
                       const FrictionFinding& friction, bool has_contacts) {
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

bool has_contact_time(const detail::KnownScene& known) {
  return known.bounds.upper[4] > 0;
}

void free_contact(const detail::SceneData& data, const detail::KnownScene& smooth, int threads, Findings& findings) {
  detail::WiderSearch freed = detail::search_contact(data, smooth, findings.search, threads);
  // Where no contact that takes time is found they are hard, and nothing is stated of their time.
  if (!freed.scenes.best.usable && findings.search.best.usable) return;
  findings.known = smooth;
  findings.search = std::move(freed.scenes);
  findings.contact_evidence = freed.evidence;
}

void free_friction(const detail::FreeMasses& masses, const detail::KnownScene& rubbing,
                   const SceneIdentificationOptions& options, Findings& findings) {
  const detail::SceneData& data = masses.data();
  FrictionFinding& friction = findings.friction;
  friction.verdict = FrictionVerdict::undecided;
  friction.parameters = masses.free_count();
  friction.residuals = data.points.size() * data.residuals_per_point();
  if (friction.residuals <= friction.parameters) return;
  detail::WiderSearch rubbed = detail::search_friction(data, rubbing, findings.known, findings.search, options.threads);
  friction.is_found = rubbed.scenes.best.usable;
  if (!friction.is_found) return;
  friction.evidence = rubbed.evidence;
  const bool is_told = rubbed.evidence > significant_friction &&
                       excludes_none(masses, rubbed.scenes.best, options.sigma_is_measured ? 1 : 0);
  if (is_told) friction.verdict = FrictionVerdict::present;
  // A limit of friction that is given is one of the scene.
  const bool is_given = std::any_of(options.constraints.begin(), options.constraints.end(),
                                    [](const auto& each) { return each.name.starts_with("friction"); });
  if (is_told || is_given || options.friction == FrictionModel::estimate) {
    findings.known = rubbing;
    findings.search = std::move(rubbed.scenes);
  } else {
    findings.undecided.scenes = std::move(rubbed.scenes.rivals);
    findings.undecided.scenes.push_back(std::move(rubbed.scenes.best));
  }
}

// A likelihood ratio alone may come from points that one of the two leaves out.
bool is_contact_told(double evidence, const SceneEstimate& time) {
  return evidence > detail::significant * detail::significant && (time.fixed || time.ci95_lower > 0);
}

// At a limit of one parameter the intervals of the others hold for a scene that has it there.
bool is_at_limit(const detail::FreeMasses::Estimates& estimates, bool takes_time, ContactModel contact) {
  const auto any_at_bound = [](const auto& of) {
    return std::any_of(of.begin(), of.end(), [](const SceneEstimate& estimate) { return estimate.at_bound; });
  };
  if (any_at_bound(estimates.friction) || any_at_bound(estimates.parameters)) return true;
  if (estimates.contact.empty()) return takes_time;
  const SceneEstimate& time = estimates.contact.front();
  return time.at_bound || (contact == ContactModel::compliant && !(time.value > 0));
}

std::vector<RivalScene> rivals_of(const detail::FreeMasses& masses, const detail::SceneAnswer& answer,
                                  const detail::LocalScene& best) {
  std::vector<RivalScene> rivals;
  for (const detail::LocalScene& rival : answer.rivals) {
    const std::vector<detail::Quantity> values = masses.parameters(rival.theta);
    rivals.push_back({{values[0].value, values[1].value, values[2].value, values[3].value},
                      values[4].value,
                      {values[5].value, values[6].value},
                      std::exp(0.5 * (rival.deviance - best.deviance))});
  }
  return rivals;
}

// What the best scene tells.
void state(const detail::SceneData& data, const detail::KnownScene& smooth, const Findings& findings,
           const SceneIdentificationOptions& options, SceneIdentification& result) {
  const detail::FreeMasses masses(data, findings.known);
  const detail::LocalScene& best = findings.search.best;
  detail::SceneAnswer answer =
      detail::answer_of(masses, findings.search, options.sigma_is_measured, findings.undecided);
  const bool has_contacts = detail::tells_contacts(data, best.choices, masses.free_count(), answer.least_variance);
  detail::FreeMasses::Estimates estimates = detail::FreeMasses::sorted(answer.estimates);
  if (!estimates.contact.empty() && is_contact_told(findings.contact_evidence, estimates.contact.front()))
    result.contact_verdict = ContactVerdict::compliant;
  // Without a scene that has friction nothing is known of what it would change.
  const bool is_friction_unknown = findings.friction.verdict != FrictionVerdict::none && !findings.friction.is_found;
  if (!answer.misfits.empty() || !answer.converged || !has_contacts || is_friction_unknown ||
      is_at_limit(estimates, has_contact_time(smooth), options.contact)) {
    detail::take_back(answer.estimates);
    estimates = detail::FreeMasses::sorted(answer.estimates);
  }
  result.parameters = std::move(estimates.parameters);
  result.combinations = std::move(estimates.combinations);
  result.contact = std::move(estimates.contact);
  result.friction = std::move(estimates.friction);
  detail::fill_in(answer, findings.search, result);
  for (std::size_t k = 0; k < result.covariance.size(); ++k)
    std::copy_n(answer.covariance[k].begin(), result.covariance[k].size(), result.covariance[k].begin());
  result.free_directions = answer.free_directions;
  result.rivals = rivals_of(masses, answer, best);
  const double longest = smooth.bounds.upper[4] * data.time_unit;
  result.message = message_of(result, answer, longest, findings.friction, has_contacts);
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
  const detail::KnownScene rubbing = detail::known_scene(data, options), smooth = detail::frictionless(rubbing);
  const detail::KnownScene hard = detail::with_hard_contacts(smooth);
  detail::require_residuals(data, hard.bounds.free_count());
  const std::vector<double> jumps = detail::products_from_jumps(curves);
  Findings findings{hard, detail::search_scene(data, hard, jumps, options.threads)};
  const detail::FreeMasses with_friction(data, rubbing);
  findings.undecided.family = &with_friction;
  if (has_contact_time(smooth)) free_contact(data, smooth, options.threads, findings);
  if (detail::has_friction(rubbing.bounds)) free_friction(with_friction, rubbing, options, findings);

  SceneIdentification result = nothing_found(findings.known);
  result.starts = findings.search.starts;
  result.starts_at_best = findings.search.starts_at_best;
  result.contact_verdict = options.contact == ContactModel::hard ? ContactVerdict::hard : ContactVerdict::undecided;
  result.contact_evidence = findings.contact_evidence;
  result.friction_verdict = findings.friction.verdict;
  result.friction_evidence = findings.friction.evidence;
  if (findings.search.best.usable) state(data, smooth, findings, options, result);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace backlash
