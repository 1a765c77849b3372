// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include "base/short_text.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/robust_tune.hpp"
#include "frac/identification/tune.hpp"
#include "identification/statistics/estimates.hpp"

namespace frac {

using detail::short_text;

std::string detail::summary_line(const ParameterEstimate& estimate, bool without_noise) {
  std::string text = "  " + estimate.name + " = " + short_text(estimate.value);
  if (estimate.fixed) return text + ", fixed\n";
  if (!without_noise && std::isfinite(estimate.ci95_lower) && std::isfinite(estimate.ci95_upper))
    text += ", 95 % within " + short_text(estimate.ci95_lower) + " .. " + short_text(estimate.ci95_upper);
  if (estimate.at_bound) text += ", at its bound";
  if (!without_noise && !estimate.identified) text += ", not identified";
  return text + "\n";
}

std::string FitResult::summary() const {
  std::string text = model + "\n";
  for (const ParameterEstimate& each : parameters) text += detail::summary_line(each, without_noise);
  return text + "rms residual " + short_text(rms) + ", largest " + short_text(max_residual) + ". " + message +
         (without_noise ? "\n" + std::string(no_noise_sentence) : "");
}

std::string IdentificationResult::summary() const {
  RankedFit best = ranking.at(chosen);
  best.fit.without_noise = without_noise();
  return (without_noise() ? "" : verdict_sentence + "\n") +
         "Chosen: " + (best.name == best.fit.model ? "" : best.name + ", ") + best.fit.summary();
}

bool IdentificationResult::without_noise() const {
  return std::any_of(ranking.begin(), ranking.end(), [](const RankedFit& each) { return each.fit.without_noise; });
}

std::string TuningResult::summary() const {
  std::string text = short_text(gains.kp);
  if (gains.ki != 0) text += " + " + short_text(gains.ki) + "/s^" + short_text(gains.lambda);
  if (gains.kd != 0) text += " + " + short_text(gains.kd) + " s^" + short_text(gains.mu);
  for (const ReachedSpecification& each : specification) {
    text += "\n  " + each.name + ": " + short_text(each.reached) + ", asked " + short_text(each.asked) +
            (each.met ? "" : ", not met");
  }
  return text + "\nMaximum sensitivity " + short_text(max_sensitivity) + ". " + message;
}

std::string RobustTuningResult::summary() const {
  return nominal.summary() + "\nOver the region: maximum sensitivity " + short_text(max_sensitivity) + ", crossover " +
         short_text(lowest_crossover) + " .. " + short_text(highest_crossover) + " rad/s. " + message;
}

}  // namespace frac
