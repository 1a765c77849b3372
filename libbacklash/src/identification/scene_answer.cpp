// SPDX-License-Identifier: BSD-3-Clause
#include "scene_answer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "scene_adequacy.hpp"
#include "scene_uncertainty.hpp"
#include "special/distributions.hpp"

namespace backlash::detail {
namespace {

using frac::detail::short_text;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Whether residuals over deviations that were measured are larger than errors of these explain, once in a thousand,
// were they all from one estimate of the fewest degrees of freedom that response() has.  Less only widens the
// intervals.
std::optional<std::string> excess(const NormalEquations& equations, std::size_t parameters) {
  constexpr double fewest_degrees = 9, chance = 1e-3;
  if (equations.residuals <= parameters) return std::nullopt;
  const auto degrees = static_cast<double>(equations.residuals - parameters);
  // A deviation of Student's distribution is larger than that of the normal one by this variance.
  const double ratio = equations.cost / degrees * fewest_degrees / (fewest_degrees - 2);
  if (frac::detail::fisher_f_above(ratio, degrees, fewest_degrees) >= chance) return std::nullopt;
  return "The residuals are " + short_text(std::sqrt(equations.cost / degrees)) +
         " times as large as the deviations that were measured.";
}

// Stretches intervals over those of another scene that explains the data nearly as well.
void stretch_over(const std::vector<SceneEstimate>& rival, std::vector<SceneEstimate>& estimates) {
  for (SceneEstimate& estimate : estimates) {
    if (estimate.fixed || estimate.at_bound) continue;
    for (const SceneEstimate& other : rival) {
      if (other.name != estimate.name) continue;
      // A rival at a limit has a value only.
      const bool has_interval = std::isfinite(other.ci95_lower);
      estimate.ci95_lower = std::min(estimate.ci95_lower, has_interval ? other.ci95_lower : other.value);
      estimate.ci95_upper = std::max(estimate.ci95_upper, has_interval ? other.ci95_upper : other.value);
      estimate.identified = is_narrow(estimate);
    }
  }
}

// Whether a value of the rival lies outside of the interval that the estimate has by itself.  One that lies within all
// of them is the same scene, at another choice of motions: whether the search ends there too is for rounding to say.
bool is_another_scene(const std::vector<SceneEstimate>& rival, const std::vector<SceneEstimate>& own) {
  for (std::size_t k = 0; k < own.size(); ++k) {
    const double value = rival[k].value;
    if (own[k].at_bound ? value != own[k].value : value < own[k].ci95_lower || value > own[k].ci95_upper) return true;
  }
  return false;
}

void report_points(const SceneData& data, const LocalScene& local, SceneAnswer& answer) {
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const MeasuredPoint& point = data.points[i];
    const PointChoice& choice = local.choices[i];
    ScenePoint reported{
        point.curve, point.index, point.omega, status_of(choice), local.motions->regime(local.theta, point, choice),
        {nan, nan},  {nan, nan}};
    if (reported.status != PointStatus::irregular) {
      reported.model = choice.model;
      reported.residual = (choice.model - point.value) / data.deviation(point, choice.model);
    }
    if (reported.status == PointStatus::used) {
      ++answer.points_used;
      for (const double part : data.parts(reported.residual))
        answer.max_residual = std::max(answer.max_residual, std::abs(part));
    }
    answer.points.push_back(reported);
  }
}

}  // namespace

SceneAnswer answer_of(const SceneFamily& family, const SceneSearch& found, bool sigma_is_measured,
                      const UndecidedScenes& undecided) {
  const SceneData& data = family.data();
  const LocalScene& best = found.best;
  const NormalEquations equations = normal_equations(data, best);
  const SceneAdequacy adequacy = scene_adequacy(data, best.choices, family.free_count());
  SceneAnswer answer;
  answer.misfits = adequacy.misfits;
  answer.is_tested = adequacy.is_tested;
  answer.residual_correlation = adequacy.correlation;
  if (sigma_is_measured)
    if (const auto misfit = excess(equations, family.free_count())) answer.misfits.push_back(*misfit);
  // The factor by which the standard error of a mean is larger for an autoregressive sequence than for white noise.
  const double widening = std::sqrt((1 + adequacy.correlation) / (1 - adequacy.correlation));
  answer.least_variance = sigma_is_measured ? 1 : 0;
  const ResidualScatter scatter{widening, answer.least_variance};
  const auto estimates_at = [&](const SceneFamily& of, const LocalScene& scene) {
    return of.estimates(SceneUncertainty(of, scene.theta, normal_equations(data, scene), scatter));
  };
  const SceneUncertainty uncertainty(family, best.theta, equations, scatter);
  const std::vector<SceneEstimate> own = family.estimates(uncertainty);
  answer.estimates = own;
  for (const LocalScene& rival : found.rivals) {
    const std::vector<SceneEstimate> other = estimates_at(family, rival);
    if (!is_another_scene(other, own)) continue;
    stretch_over(other, answer.estimates);
    answer.rivals.push_back(rival);
  }
  for (const LocalScene& other : undecided.scenes)
    stretch_over(estimates_at(*undecided.family, other), answer.estimates);
  const std::vector<std::string> strained = uncertainty.strained();
  answer.misfits.insert(answer.misfits.end(), strained.begin(), strained.end());
  answer.free_directions = uncertainty.free_directions();
  answer.covariance = uncertainty.covariance(family.parameters(best.theta));
  answer.condition = uncertainty.condition();
  answer.rank = uncertainty.rank();
  report_points(data, best, answer);
  answer.cost = equations.cost;
  answer.residuals = equations.residuals;
  answer.rms = std::sqrt(equations.cost / static_cast<double>(equations.residuals));
  answer.converged = best.converged;
  return answer;
}

void take_back(std::span<SceneEstimate> estimates) {
  for (SceneEstimate& estimate : estimates) estimate.identified = estimate.fixed;
}

std::string message_of(const SceneAnswer& answer, std::span<const SceneEstimate> parameters,
                       const MessageParts& parts) {
  using frac::detail::listed;
  std::vector<std::string> determined, open, at_bound;
  for (const SceneEstimate& parameter : parameters) {
    if (parameter.fixed) continue;
    (parameter.at_bound ? at_bound : parameter.identified ? determined : open).push_back(parameter.name);
  }
  const bool is_given = determined.empty() && open.empty() && at_bound.empty(), fits = answer.misfits.empty();
  std::string text = std::to_string(answer.points_used) + " of " + std::to_string(answer.points.size()) +
                     " points, rms " + short_text(answer.rms) + ", ";
  if (is_given) {
    text += "compared with the given scene";
    if (fits) text += answer.is_tested ? ", which describes them" : "; too few of them are neighbours to judge it";
  } else {
    text += determined.empty() ? "determine none of the free parameters" : "determine " + listed(determined);
  }
  if (!at_bound.empty()) text += "; " + listed(at_bound) + " at a limit: fix what is known to lie there";
  if (!open.empty()) text += "; " + listed(open) + " not identified";
  if (!answer.converged) text += "; the search had not settled when it was ended";
  if (answer.residual_correlation > 0 && fits) {
    text += "; neighbouring residuals go together (correlation " + short_text(answer.residual_correlation) + ")" +
            (is_given ? "" : ", which widens the intervals");
  }
  text += "." + parts.of_family;
  if (parts.ends && !is_given) return text;
  if (!answer.rivals.empty()) {
    text += " Other scenes explain the data nearly as well, and the intervals reach over them" +
            std::string(parts.lists_rivals ? ": see rivals." : ".");
  }
  for (const std::string& misfit : answer.misfits) text += " " + misfit;
  if (fits) return text;
  return text + " The scene does not describe the data" + (is_given ? "." : ", so that nothing counts as identified.") +
         parts.of_misfit;
}

}  // namespace backlash::detail
