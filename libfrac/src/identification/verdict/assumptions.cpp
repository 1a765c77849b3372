// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/assumptions.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/physical_properties.hpp"
#include "identification/statistics/smooth_error.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/verdict_sentence.hpp"

namespace frac::detail {
namespace {

/// What a model does that is taken not to be.
struct Liberties {
  bool unstable = false, delayed = false, active = false;

  [[nodiscard]] int count() const { return int{unstable} + int{delayed} + int{active}; }
  /// "a pole right of the imaginary axis and a dead time"
  [[nodiscard]] std::string text() const {
    std::vector<std::string> each;
    if (unstable) each.emplace_back("poles right of the imaginary axis");
    if (delayed) each.emplace_back("a dead time");
    if (active) each.emplace_back("a negative real part");
    return listed(each);
  }
};

Liberties liberties_of(const RankedFit& ranked, const FrequencyResponseData& data, const Assumptions& assumptions) {
  Liberties result;
  if (ranked.model_class == ModelClass::fixed_curve) return result;
  if (assumptions.stable.value_or(true)) result.unstable = is_unstable(ranked.fit).value_or(false);
  if (!assumptions.dead_time) result.delayed = has_dead_time(Structure(ranked.fit.model));
  if (assumptions.passive) result.active = active_place(ranked.fit, data).has_value();
  return result;
}

}  // namespace

void keep_to_assumptions(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                         const std::vector<Competitor>& competitors) {
  const Assumptions& assumptions = options.assumptions;
  const Competitor& chosen = competitors.at(result.chosen);
  const Liberties taken = liberties_of(chosen.ranked, data, assumptions);
  if (taken.count() == 0) return;
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < competitors.size(); ++i) {
    const Competitor& each = competitors[i];
    const bool rival = each.ranked.model_class == chosen.ranked.model_class && is_comparable(each) &&
                       each.ranked.fit.termination == FitTermination::converged;
    if (!rival || !(criterion(each) < least) || liberties_of(each.ranked, data, assumptions).count() > 0) continue;
    least = criterion(each);
    best = i;
  }
  if (!best) {
    result.notes.push_back("'" + chosen.ranked.name + "' has " + taken.text() +
                           "; no candidate of its class has none.");
    return;
  }
  const Competitor& without = competitors[*best];
  const auto leftover = [&](const Competitor& each) {
    return Leftover{each.ranked.fit.relative_rms,
                    autocorrelation(each.residual, residuals_per_point(data, options), 1)};
  };
  const double evidence = evidence_against(leftover(without), leftover(chosen), chosen.residual.size());
  const bool excluded = assumptions.stable == true && taken.unstable;
  const std::string comparison = described(chosen.ranked) + " with " + taken.text() + ", " + described(without.ranked) +
                                 " without, evidence " + four_digits(evidence);
  if (evidence > taken.count() * price_of_assumption() && !excluded) {
    result.notes.push_back("The data speak for " + taken.text() + ": " + comparison + ".");
    return;
  }
  result.notes.push_back("Chosen is a model without " + taken.text() + ": " + comparison + ", which is too little.");
  result.set_aside = result.chosen;
  result.chosen = *best;
}

}  // namespace frac::detail
