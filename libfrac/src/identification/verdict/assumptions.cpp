// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/assumptions.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include "base/short_text.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/physical_properties.hpp"
#include "identification/statistics/assumption_evidence.hpp"
#include "identification/verdict/evidence.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/verdict_sentence.hpp"

namespace frac::detail {
namespace {

/// What a model does that is taken not to be.
struct Liberties {
  bool unstable = false, active = false, delayed = false;
};

/// Liberties of the candidates of a ranking; each is looked at once, when it is asked for.
class Candidates {
 public:
  Candidates(const std::vector<Competitor>& competitors, const FrequencyResponseData& data, const FitOptions& options)
      : competitors_(competitors), data_(data), options_(options), liberties_(competitors.size()) {}

  [[nodiscard]] const Competitor& operator[](std::size_t i) const { return competitors_.at(i); }
  const Liberties& liberties(std::size_t i) {
    if (!liberties_[i]) liberties_[i] = liberties_of(competitors_[i].ranked);
    return *liberties_[i];
  }
  /// The candidate of the class of `chosen` with the least `value` that `keeps` says yes to.
  template <class Keeps, class Value>
  std::optional<std::size_t> best(std::size_t chosen, const Keeps& keeps, const Value& value) {
    std::optional<std::size_t> found;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < competitors_.size(); ++i) {
      const Competitor& each = competitors_[i];
      const bool rival = each.ranked.model_class == competitors_[chosen].ranked.model_class && is_comparable(each) &&
                         each.ranked.fit.termination == FitTermination::converged;
      if (!rival || !keeps(liberties(i)) || !(value(i) < least)) continue;
      least = value(i);
      found = i;
    }
    return found;
  }
  [[nodiscard]] double correlation(std::size_t i) const { return leftover(i).correlation; }
  /// Evidence against one candidate by another.
  [[nodiscard]] double against(std::size_t held, std::size_t rival) const {
    return evidence_against(leftover(held), leftover(rival), competitors_[rival].residual.size());
  }
  /// "'lag' (2 parameters, rms 1.2 %) against 'lag-delay' (3 parameters, rms 1.1 %), evidence 0.3"
  [[nodiscard]] std::string comparison(std::size_t without, std::size_t chosen, double evidence) const {
    return described(competitors_[without].ranked) + " against " + described(competitors_[chosen].ranked) +
           ", evidence for the latter " + four_digits(evidence);
  }

 private:
  [[nodiscard]] Leftover leftover(std::size_t i) const {
    return leftover_of(competitors_[i], residuals_per_point(data_, options_));
  }
  [[nodiscard]] Liberties liberties_of(const RankedFit& ranked) const {
    Liberties result;
    const Assumptions& assumptions = options_.assumptions;
    if (ranked.model_class == ModelClass::fixed_curve) return result;
    if (assumptions.stable.value_or(true)) result.unstable = is_unstable(ranked.fit).value_or(false);
    if (assumptions.passive) result.active = active_place(ranked.fit, data_).has_value();
    if (!assumptions.dead_time) result.delayed = has_dead_time(Structure(ranked.fit.model));
    return result;
  }

  const std::vector<Competitor>& competitors_;
  const FrequencyResponseData& data_;
  const FitOptions& options_;
  std::vector<std::optional<Liberties>> liberties_;
};

void choose(IdentificationResult& result, std::size_t index) {
  if (!result.set_aside) result.set_aside = result.chosen;
  result.chosen = index;
}

void keep_to_physics(IdentificationResult& result, const FitOptions& options, Candidates& candidates) {
  const std::size_t chosen = result.chosen;
  const Liberties taken = candidates.liberties(chosen);
  const int count = int{taken.unstable} + int{taken.active};
  if (count == 0) return;
  const std::string what = !taken.active     ? "poles right of the imaginary axis"
                           : !taken.unstable ? "a negative real part"
                                             : "poles right of the imaginary axis and a negative real part";
  const auto keeps = [](const Liberties& each) { return !each.unstable && !each.active; };
  const auto without = candidates.best(chosen, keeps, [&](std::size_t i) { return candidates.against(i, chosen); });
  if (!without) {
    result.notes.push_back("'" + candidates[chosen].ranked.name + "' has " + what +
                           ", and no candidate of its class is without.");
    return;
  }
  const double evidence = candidates.against(*without, chosen);
  const std::string comparison = candidates.comparison(*without, chosen, evidence);
  const bool spoken = evidence > count * price_of_assumption;
  const bool excluded = options.assumptions.stable == true && taken.unstable;
  // Of two families that were cut, further poles might bring the one without as close.
  const bool cut = candidates[chosen].ranked.model.ends_its_family && candidates[*without].ranked.model.ends_its_family;
  if (spoken && !excluded && !cut) {
    result.notes.push_back("The data speak for " + what + ": " + comparison + ".");
    return;
  }
  const std::string though = !spoken    ? ""
                             : excluded ? ", but they are excluded"
                                        : ", but both have as many poles as are tried";
  result.notes.push_back("The data " + std::string(spoken ? "" : "do not ") + "speak for " + what + ": " + comparison +
                         though + "; a model without is chosen.");
  // What is chosen may follow a smooth error: that is no reason against what it is.
  choose(result, *candidates.best(chosen, keeps, [&](std::size_t i) { return criterion(candidates[i]); }));
}

/// A dead time is nothing that a system has or has not by its nature.  It pays the price of its parameter by Schwarz's
/// criterion, where it saves those of the poles and zeros that approximate it.
void keep_to_no_dead_time(IdentificationResult& result, Candidates& candidates) {
  const std::size_t chosen = result.chosen;
  const Liberties taken = candidates.liberties(chosen);
  if (!taken.delayed) return;
  const auto without = candidates.best(
      chosen,
      [&](const Liberties& each) {
        return !each.delayed && each.unstable <= taken.unstable && each.active <= taken.active;
      },
      [&](std::size_t i) { return criterion(candidates[i]); });
  if (!without) return;
  const double evidence = (criterion(candidates[*without]) - criterion(candidates[chosen])) *
                          independent_share(candidates.correlation(*without));
  const std::string comparison = candidates.comparison(*without, chosen, evidence);
  if (evidence > price_of_dead_time) {
    result.notes.push_back("The data speak for a dead time: " + comparison + ".");
    return;
  }
  result.notes.push_back("Chosen is a model without a dead time: " + comparison + ".");
  choose(result, *without);
}

/// Whether the verdict leaves a model of this class to be chosen.
bool goes_with_verdict(const Competitor& competitor, Verdict verdict) {
  if (refuses_whole_orders(verdict)) return competitor.is_fractional();
  if (verdict == Verdict::fractional_not_supported) return !competitor.is_fractional();
  return true;
}

}  // namespace

void prefer_elements(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                     const std::vector<Competitor>& competitors) {
  const auto found = std::find_if(competitors.begin(), competitors.end(), [](const Competitor& each) {
    return (each.passive || each.is_such_a_sum) && each.ranked.fit.termination == FitTermination::converged &&
           is_comparable(each);
  });
  if (found == competitors.end() || !goes_with_verdict(*found, result.verdict)) return;
  const std::size_t chosen = result.chosen, passive = static_cast<std::size_t>(found - competitors.begin());
  if (passive == chosen || !competitors[chosen].ranked.from_family) return;
  const Candidates candidates(competitors, data, options);
  const double evidence = candidates.against(passive, chosen);
  if (evidence > price_of_assumption) return;
  result.notes.push_back("Chosen is a sum of passive elements: " + candidates.comparison(passive, chosen, evidence) +
                         ".");
  result.chosen = passive;
  result.set_aside.reset();
}

void keep_to_assumptions(IdentificationResult& result, const FrequencyResponseData& data, const FitOptions& options,
                         const std::vector<Competitor>& competitors) {
  Candidates candidates(competitors, data, options);
  keep_to_physics(result, options, candidates);
  keep_to_no_dead_time(result, candidates);
}

}  // namespace frac::detail
