// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include "base/short_text.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/robust_tune.hpp"
#include "frac/identification/tune.hpp"

namespace frac {

using detail::short_text;

std::string FitResult::summary() const {
  std::string text = model + "\n";
  for (const ParameterEstimate& each : parameters) {
    text += "  " + each.name + " = " + short_text(each.value);
    if (each.fixed) {
      text += ", fixed";
    } else if (std::isfinite(each.ci95_lower) && std::isfinite(each.ci95_upper)) {
      text += ", 95 % within " + short_text(each.ci95_lower) + " .. " + short_text(each.ci95_upper);
    }
    if (each.at_bound) text += ", at its bound";
    if (!each.fixed && !each.identified) text += ", not identified";
    text += "\n";
  }
  return text + "rms residual " + short_text(rms) + ", largest " + short_text(max_residual) + ". " + message;
}

std::string IdentificationResult::summary() const {
  const RankedFit& best = ranking.at(chosen);
  return verdict_sentence + "\nChosen: " + (best.name == best.fit.model ? "" : best.name + ", ") + best.fit.summary();
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
