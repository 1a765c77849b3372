// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/scene_identification.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/counted.hpp"
#include "base/median.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "scene_adequacy.hpp"
#include "scene_data.hpp"
#include "scene_search.hpp"
#include "scene_uncertainty.hpp"
#include "special/distributions.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash {
namespace {

using detail::SceneVector;
using Complex = std::complex<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<std::string_view, detail::scene_size> parameter_names = {
    "mass1", "mass2", "clearance", "restitution", "contact_time", "friction1", "friction2"};
constexpr frac::detail::Spellings<ContactModel, 3> contact_spellings = {
    {{ContactModel::hard, "hard"}, {ContactModel::compliant, "compliant"}, {ContactModel::automatic, "auto"}}};
constexpr frac::detail::Spellings<FrictionModel, 3> friction_spellings = {
    {{FrictionModel::none, "none"}, {FrictionModel::automatic, "auto"}, {FrictionModel::estimate, "estimate"}}};
// Standard deviations that chance exceeds on one side once in a thousand.
constexpr double significant_contact = 3.09;
// Twice the logarithm of a likelihood ratio that chance exceeds once in a thousand where two parameters may rise from
// 0: it is 0 with probability 1/4, chi squared of one degree with 1/2 and of two with 1/4.
constexpr double significant_friction = 11.8;

// Factor by which masses and clearance may differ from what the data suggest.
const double default_range = std::log(1e6);
std::string allowed_range(std::size_t k) {
  return k >= 4 ? "0 or greater and finite" : k == 3 ? "in [0, 1]" : "positive and finite";
}

// A value the user gives for a parameter, as a coordinate of the search.
double coordinate(std::size_t k, const char* what, double value, const detail::SceneData& data) {
  const bool allowed = k >= 4   ? value >= 0 && std::isfinite(value)
                       : k == 3 ? value >= 0 && value <= 1
                                : value > 0 && std::isfinite(value);
  if (!allowed) {
    throw std::invalid_argument(std::string(parameter_names[k]) + ": " + what + " is " + detail::text(value) +
                                "; it must be " + allowed_range(k));
  }
  if (k >= detail::first_friction) return value / data.force_unit;
  return k == 4 ? value / data.time_unit : k == 3 ? value : std::log(value);
}

detail::KnownScene known_scene(const detail::SceneData& data, const std::vector<frac::ParameterConstraint>& constraints,
                               ContactModel contact, FrictionModel friction) {
  std::vector<double> masses, amplitudes;
  for (const detail::MeasuredPoint& point : data.points) {
    const double size = std::abs(point.value);
    if (!(size > 0) || point.harmonic != 1) continue;
    masses.push_back(-std::log(size) - 2 * std::log(point.omega));
    amplitudes.push_back(std::log(point.force) + std::log(size));
  }
  const double mass = frac::detail::median(masses);
  const double amplitude = frac::detail::median(amplitudes);
  detail::KnownScene known{};
  known.bounds.lower = {mass - default_range, mass - default_range, amplitude - default_range, 0, 0, 0, 0};
  known.bounds.upper = {mass + default_range,
                        mass + default_range,
                        amplitude + default_range,
                        1,
                        contact == ContactModel::hard ? 0 : std::numbers::pi,
                        friction == FrictionModel::none ? 0.0 : 1.0,
                        friction == FrictionModel::none ? 0.0 : 1.0};
  std::array<bool, detail::scene_size> seen{};
  for (const frac::ParameterConstraint& constraint : constraints) {
    const auto name = std::find(parameter_names.begin(), parameter_names.end(), constraint.name);
    if (name == parameter_names.end()) {
      throw std::invalid_argument(
          "constraint of '" + constraint.name +
          "': the scene has mass1, mass2, clearance, restitution, contact_time, friction1 and friction2 only");
    }
    const auto k = static_cast<std::size_t>(name - parameter_names.begin());
    if (k == 4 && contact == ContactModel::hard)
      throw std::invalid_argument("contact_time is constrained, but the contact is hard, which is contact time 0");
    if (k >= detail::first_friction && friction == FrictionModel::none)
      throw std::invalid_argument(constraint.name + " is constrained, but there is to be no friction");
    if (seen[k]) throw std::invalid_argument(constraint.name + " is constrained twice");
    seen[k] = true;
    if (constraint.fixed) {
      if (constraint.lower || constraint.upper || constraint.start) {
        throw std::invalid_argument(constraint.name + " is fixed; limits or a start beside that have no meaning");
      }
      if (k < known.fixed.size()) known.fixed[k] = *constraint.fixed;
      known.bounds.lower[k] = known.bounds.upper[k] = coordinate(k, "the fixed value", *constraint.fixed, data);
      continue;
    }
    if (constraint.lower) {
      known.bounds.lower[k] = coordinate(k, "the lower limit", *constraint.lower, data);
      if (!constraint.upper) known.bounds.upper[k] = std::max(known.bounds.upper[k], known.bounds.lower[k] + 1);
    }
    if (constraint.upper) {
      known.bounds.upper[k] = coordinate(k, "the upper limit", *constraint.upper, data);
      if (!constraint.lower) known.bounds.lower[k] = std::min(known.bounds.lower[k], known.bounds.upper[k] - 1);
    }
    if (k >= 3) known.bounds.lower[k] = std::max(known.bounds.lower[k], 0.0);
    if (k == 3) {
      known.bounds.upper[k] = std::min(known.bounds.upper[k], 1.0);
    }
    if (!known.bounds.is_free(k)) {
      throw std::invalid_argument(constraint.name + ": the lower limit " +
                                  (constraint.lower ? detail::text(*constraint.lower) : std::string("by default")) +
                                  " is not below the upper limit " +
                                  (constraint.upper ? detail::text(*constraint.upper) : std::string("by default")));
    }
    if (constraint.start) {
      const double start = coordinate(k, "the start", *constraint.start, data);
      if (start < known.bounds.lower[k] || start > known.bounds.upper[k]) {
        throw std::invalid_argument(constraint.name + ": the start " + detail::text(*constraint.start) +
                                    " lies outside the limits");
      }
      if (k < known.start.size()) known.start[k] = start;
    }
  }
  return known;
}

// Of an estimate whose contact time is free.
Regime regime_of_contact(const detail::PointChoice& choice, double gamma, const detail::SceneVector& theta) {
  using Kind = detail::PointChoice::Kind;
  if (choice.kind == Kind::free) return Regime::free;
  if (choice.kind == Kind::two_impact) return Regime::symmetric;
  if (choice.kind == Kind::none) return Regime::averaged;
  // At contact time 0 what sticks, and the asymmetric orbit of two impacts.
  const bool sticks = theta[4] == 0 && theta[3] > 0 && gamma > detail::two_impact_loss(theta[3]).gamma;
  return sticks ? Regime::chatter : Regime::periodic;
}

Regime regime_of(const detail::PointChoice& choice, double gamma, double restitution) {
  switch (choice.kind) {
    case detail::PointChoice::Kind::two_impact:
      return gamma <= detail::symmetry_breaking_gamma(restitution) ? Regime::symmetric : Regime::periodic;
    case detail::PointChoice::Kind::sticking:
      return restitution > 0 ? Regime::chatter : Regime::periodic;
    case detail::PointChoice::Kind::free:
      return Regime::free;
    case detail::PointChoice::Kind::none:
      break;
  }
  return Regime::averaged;
}

// Whose halves need not mirror each other.
Regime regime_of_friction(const detail::PointChoice& choice) {
  return choice.kind == detail::PointChoice::Kind::none ? Regime::averaged : Regime::periodic;
}

void report_points(const detail::SceneData& data, const detail::LocalScene& local, SceneIdentification& result) {
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const detail::MeasuredPoint& point = data.points[i];
    const detail::PointChoice& choice = local.choices[i];
    const double gamma = detail::gamma_at(local.theta, point);
    ScenePoint reported{point.curve,
                        point.index,
                        point.omega,
                        detail::status_of(choice),
                        !local.orbits.empty() ? regime_of_friction(choice)
                        : local.found.empty() ? regime_of(choice, gamma, local.theta[3])
                                              : regime_of_contact(choice, gamma, local.theta),
                        Complex(nan, nan),
                        Complex(nan, nan)};
    if (reported.status != PointStatus::irregular) {
      reported.model = choice.model;
      reported.residual = (choice.model - point.value) / data.deviation(point, choice.model);
    }
    if (reported.status == PointStatus::used) {
      ++result.points_used;
      for (const double part : data.parts(reported.residual)) {
        result.max_residual = std::max(result.max_residual, std::abs(part));
      }
    }
    result.points.push_back(reported);
  }
}

// Stretches the intervals of an estimate over those of another one that explains the data nearly as well.
void stretch_over(const detail::SceneUncertainty& rival, detail::SceneUncertainty& estimate) {
  for (std::size_t k = 0; k < rival.parameters.size(); ++k) {
    detail::stretch_over(rival.parameters[k], estimate.parameters[k]);
  }
  for (std::size_t c = 0; c < rival.combinations.size(); ++c) {
    detail::stretch_over(rival.combinations[c], estimate.combinations[c]);
  }
  for (std::size_t c = 0; c < std::min(rival.contact.size(), estimate.contact.size()); ++c) {
    detail::stretch_over(rival.contact[c], estimate.contact[c]);
  }
  for (std::size_t c = 0; c < std::min(rival.friction.size(), estimate.friction.size()); ++c) {
    detail::stretch_over(rival.friction[c], estimate.friction[c]);
  }
}

// Whether a value of the rival lies outside of the interval that the estimate has by itself.  One that lies within all
// of them is the same scene, at another choice of motions: whether the search ends there too is for rounding to say.
bool is_another_scene(const detail::SceneUncertainty& rival, const detail::SceneUncertainty& own) {
  const auto outside = [](const SceneEstimate& other, const SceneEstimate& estimate) {
    if (estimate.at_bound) return other.value != estimate.value;
    return other.value < estimate.ci95_lower || other.value > estimate.ci95_upper;
  };
  const auto any_outside = [&](const auto& others, const auto& estimates) {
    for (std::size_t k = 0; k < std::min(others.size(), estimates.size()); ++k)
      if (outside(others[k], estimates[k])) return true;
    return false;
  };
  return any_outside(rival.parameters, own.parameters) || any_outside(rival.combinations, own.combinations) ||
         any_outside(rival.contact, own.contact) || any_outside(rival.friction, own.friction);
}

// Whether residuals over deviations that were measured are larger than errors of these explain, once in a thousand,
// were they all from one estimate of the fewest degrees of freedom that response() has.  Less only widens the
// intervals.
std::optional<std::string> excess(const detail::NormalEquations& equations, std::size_t parameters) {
  constexpr double fewest_degrees = 9, chance = 1e-3;
  if (equations.residuals <= parameters) return std::nullopt;
  const auto degrees = static_cast<double>(equations.residuals - parameters);
  // A deviation of Student's distribution is larger than that of the normal one by this variance.
  const double ratio = equations.cost / degrees * fewest_degrees / (fewest_degrees - 2);
  if (frac::detail::fisher_f_above(ratio, degrees, fewest_degrees) >= chance) return std::nullopt;
  return "The residuals are " + frac::detail::short_text(std::sqrt(equations.cost / degrees)) +
         " times as large as the deviations that were measured.";
}

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

std::string friction_text(const SceneIdentification& result) {
  using frac::detail::short_text;
  if (result.friction.empty()) {
    return result.friction_verdict == FrictionVerdict::none ? ""
           : std::isnan(result.friction_evidence)
               ? " Nowhere that was tried do enough points lie on a motion with friction, so that nothing is known of "
                 "it."
               : " The data do not tell friction from none, and the intervals hold for both.";
  }
  const auto& [load, drive] = std::array{result.friction[0], result.friction[1]};
  if (load.fixed && drive.fixed) return "";
  if (result.friction_verdict == FrictionVerdict::present) {
    return " The data tell friction from none: " + short_text(load.value) + " N on mass 1 and " +
           short_text(drive.value) + " N on mass 2 (twice the log likelihood ratio " +
           short_text(result.friction_evidence) + ").";
  }
  std::string text = " The data do not tell friction from none, and the intervals hold for both";
  if (std::isfinite(load.ci95_upper) && std::isfinite(drive.ci95_upper)) {
    text += ": at most " + short_text(load.ci95_upper) + " N on mass 1 and " + short_text(drive.ci95_upper) +
            " N on mass 2";
  }
  return text + ".";
}

std::string message_of(const SceneIdentification& result, double longest, bool has_contacts) {
  std::vector<std::string> determined, open, at_bound;
  for (const SceneEstimate& parameter : result.parameters) {
    if (parameter.fixed) continue;
    (parameter.at_bound ? at_bound : parameter.identified ? determined : open).push_back(parameter.name);
  }
  std::string text = std::to_string(result.points_used) + " of " + std::to_string(result.points.size()) +
                     " points, rms " + frac::detail::short_text(result.rms) + ", ";
  if (determined.empty() && open.empty() && at_bound.empty()) return text + "compared with the given scene.";
  text +=
      determined.empty() ? "determine none of the free parameters" : "determine " + frac::detail::listed(determined);
  if (!at_bound.empty()) text += "; " + frac::detail::listed(at_bound) + " at a limit: fix what is known to lie there";
  if (!open.empty()) text += "; " + frac::detail::listed(open) + " not identified";
  if (result.termination != frac::FitTermination::converged) text += "; the search had not settled when it was ended";
  if (result.residual_correlation > 0 && result.misfits.empty()) {
    text += "; neighbouring residuals go together (correlation " +
            frac::detail::short_text(result.residual_correlation) + "), which widens the intervals";
  }
  text += ".";
  if (!has_contacts)
    return text + " The data do not tell the masses from ones that never touch, so that nothing counts as identified.";
  text += contact_text(result, longest) + friction_text(result);
  if (!result.rivals.empty()) {
    text += " Other scenes explain the data nearly as well, and the intervals reach over them: see rivals.";
  }
  for (const std::string& misfit : result.misfits) text += " " + misfit;
  if (result.misfits.empty()) return text;
  text += " The scene does not describe the data, so that nothing counts as identified.";
  if (result.friction_verdict == FrictionVerdict::none) text += " Dry friction, which was left out, may be why.";
  return text;
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
  const detail::KnownScene rubbing = known_scene(data, options.constraints, options.contact, options.friction);
  detail::KnownScene known = rubbing;
  for (std::size_t k = detail::first_friction; k < detail::scene_size; ++k)
    known.bounds.lower[k] = known.bounds.upper[k] = 0;
  detail::KnownScene hard = known;
  hard.bounds.lower[4] = hard.bounds.upper[4] = 0;
  const std::size_t residuals = data.points.size() * data.residuals_per_point();
  detail::require_residuals(data, hard.bounds.free_count());
  const std::vector<double> jumps = detail::products_from_jumps(curves);
  detail::SceneSearch found = detail::search_scene(data, hard, jumps, options.threads);

  SceneIdentification result{};
  result.contact_verdict = options.contact == ContactModel::hard ? ContactVerdict::hard : ContactVerdict::undecided;
  result.contact_evidence = nan;
  const bool takes_time = known.bounds.upper[4] > 0;
  const double longest = known.bounds.upper[4] * data.time_unit;
  if (takes_time) {
    detail::ContactSearch freed = detail::search_contact(data, known, found, options.threads);
    if (freed.scenes.best.usable || !found.best.usable) {
      found = std::move(freed.scenes);
      result.contact_evidence = freed.evidence;
    } else {
      // Hard contacts then, of which nothing is stated.
      known = hard;
    }
  }
  result.friction_verdict = rubbing.bounds.has_friction() ? FrictionVerdict::undecided : FrictionVerdict::none;
  result.friction_evidence = nan;
  std::vector<detail::LocalScene> undecided;  // with friction that the data do not tell from none
  if (rubbing.bounds.has_friction() && residuals >= rubbing.bounds.free_count()) {
    detail::FrictionSearch rubbed = detail::search_friction(data, rubbing, found, options.threads);
    if (rubbed.scenes.best.usable) {
      result.friction_evidence = rubbed.evidence;
      const bool is_told = rubbed.evidence > significant_friction;
      if (is_told) result.friction_verdict = FrictionVerdict::present;
      // A limit of friction that is given is one of the scene.
      const bool is_given = std::any_of(options.constraints.begin(), options.constraints.end(),
                                        [](const auto& each) { return each.name.starts_with("friction"); });
      if (is_told || is_given || options.friction == FrictionModel::estimate) {
        found = std::move(rubbed.scenes);
        known = rubbing;
      } else {
        undecided = std::move(rubbed.scenes.rivals);
        undecided.push_back(std::move(rubbed.scenes.best));
      }
    }
  }
  result.starts = found.starts;
  result.starts_at_best = found.starts_at_best;
  if (!found.best.usable) {
    result.termination = frac::FitTermination::no_usable_start;
    result.message = "No scene within the limits has steady motions at as many points as there are free parameters.";
    result.cost = result.rms = result.max_residual = result.condition = nan;
    for (std::size_t k = 0; k < 4; ++k) {
      result.parameters[k] = {std::string(parameter_names[k]), "",    nan,  nan, nan, nan,
                              known.fixed[k].has_value(),      false, false};
      result.covariance[k].fill(nan);
    }
    for (SceneEstimate& combination : result.combinations)
      combination = {"", "", nan, nan, nan, nan, false, false, false};
  } else {
    const detail::NormalEquations equations = detail::normal_equations(data, found.best);
    const detail::SceneAdequacy adequacy = detail::scene_adequacy(data, found.best.choices, known.bounds.free_count());
    result.misfits = adequacy.misfits;
    result.residual_correlation = adequacy.correlation;
    if (options.sigma_is_measured)
      if (const auto misfit = excess(equations, known.bounds.free_count())) result.misfits.push_back(*misfit);
    // The factor by which the standard error of a mean is larger for an autoregressive sequence than for white noise.
    const double widening = std::sqrt((1 + adequacy.correlation) / (1 - adequacy.correlation));
    const double least_variance = options.sigma_is_measured ? 1 : 0;
    detail::SceneUncertainty uncertainty =
        detail::scene_uncertainty(equations, known.bounds, found.best.theta, widening, least_variance, data);
    const detail::SceneUncertainty own = uncertainty;
    for (const detail::LocalScene& rival : found.rivals) {
      const detail::SceneUncertainty other = detail::scene_uncertainty(
          detail::normal_equations(data, rival), known.bounds, rival.theta, widening, least_variance, data);
      if (!is_another_scene(other, own)) continue;
      stretch_over(other, uncertainty);
      result.rivals.push_back(
          {{std::exp(rival.theta[0]), std::exp(rival.theta[1]), std::exp(rival.theta[2]), rival.theta[3]},
           rival.theta[4] * data.time_unit,
           {rival.theta[5] * data.force_unit, rival.theta[6] * data.force_unit},
           std::exp(0.5 * (rival.deviance - found.best.deviance))});
    }
    for (const detail::LocalScene& other : undecided) {
      stretch_over(detail::scene_uncertainty(detail::normal_equations(data, other), rubbing.bounds, other.theta,
                                             widening, least_variance, data),
                   uncertainty);
    }
    result.misfits.insert(result.misfits.end(), uncertainty.strained.begin(), uncertainty.strained.end());
    result.parameters = uncertainty.parameters;
    result.combinations = uncertainty.combinations;
    result.contact = uncertainty.contact;
    result.friction = uncertainty.friction;
    if (!result.contact.empty()) {
      // A likelihood ratio alone may come from points that one of the two leaves out.
      const bool is_told = result.contact_evidence > significant_contact * significant_contact &&
                           (result.contact.front().fixed || result.contact.front().ci95_lower > 0);
      result.contact_verdict = is_told ? ContactVerdict::compliant : ContactVerdict::undecided;
    }
    // At a limit of one parameter the intervals of the others hold for a scene that has it there.
    const bool is_contact_at_limit =
        result.contact.empty() ? takes_time
                               : result.contact.front().at_bound || (options.contact == ContactModel::compliant &&
                                                                     !(result.contact.front().value > 0));
    // Without a scene that has friction nothing is known of what it would change.
    const bool is_friction_unknown = rubbing.bounds.has_friction() && !known.bounds.has_friction() && undecided.empty();
    const bool at_limit = is_contact_at_limit || is_friction_unknown ||
                          std::any_of(result.friction.begin(), result.friction.end(),
                                      [](const SceneEstimate& estimate) { return estimate.at_bound; }) ||
                          std::any_of(result.parameters.begin(), result.parameters.end(),
                                      [](const SceneEstimate& estimate) { return estimate.at_bound; });
    const bool has_contacts =
        detail::tells_contacts(data, found.best.choices, known.bounds.free_count(), least_variance);
    if (!result.misfits.empty() || !found.best.converged || at_limit || !has_contacts) {
      for (SceneEstimate& estimate : result.parameters) estimate.identified = estimate.fixed;
      for (SceneEstimate& estimate : result.combinations) estimate.identified = estimate.fixed;
      for (SceneEstimate& estimate : result.contact) estimate.identified = estimate.fixed;
      for (SceneEstimate& estimate : result.friction) estimate.identified = estimate.fixed;
    }
    result.free_directions = uncertainty.free_directions;
    result.covariance = uncertainty.covariance;
    result.condition = uncertainty.condition;
    result.free_parameters = uncertainty.rank;
    for (std::size_t k = 0; k < 4; ++k) {
      // A fixed value is given back as it was, not through its logarithm.
      if (known.fixed[k]) {
        result.parameters[k].value = *known.fixed[k];
        result.parameters[k].ci95_lower = result.parameters[k].ci95_upper = *known.fixed[k];
      }
    }
    report_points(data, found.best, result);
    result.cost = equations.cost;
    result.residuals = equations.residuals;
    result.rms = std::sqrt(equations.cost / static_cast<double>(equations.residuals));
    result.termination = found.best.converged ? frac::FitTermination::converged : frac::FitTermination::not_converged;
    result.message = message_of(result, longest, has_contacts);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace backlash
