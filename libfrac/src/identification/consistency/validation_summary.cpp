// SPDX-License-Identifier: BSD-3-Clause
// Names of verdicts and tests, and the sentence on a measurement.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "frac/identification/validate.hpp"
#include "level_share.hpp"

namespace frac {

std::string_view to_string(Validity validity) {
  constexpr detail::Spellings<Validity, 4> spellings{{{Validity::valid, "valid"},
                                                      {Validity::suspect, "suspect"},
                                                      {Validity::invalid, "invalid"},
                                                      {Validity::undecided, "undecided"}}};
  return detail::spelling(spellings, validity);
}

std::string_view to_string(ValidityTest test) {
  constexpr detail::Spellings<ValidityTest, 8> spellings{{{ValidityTest::neighbours, "neighbours"},
                                                          {ValidityTest::neighbourhoods, "neighbourhoods"},
                                                          {ValidityTest::drift_even, "drift-even"},
                                                          {ValidityTest::drift_periods, "drift-periods"},
                                                          {ValidityTest::step, "step"},
                                                          {ValidityTest::outliers, "outliers"},
                                                          {ValidityTest::mains_50, "mains-50"},
                                                          {ValidityTest::mains_60, "mains-60"}}};
  return detail::spelling(spellings, test);
}

namespace {

std::string percent(double share) {
  return detail::short_text(100 * share) + " %";
}

bool alarmed(const ValidationResult& result, ValidityTest test) {
  return std::any_of(result.findings.begin(), result.findings.end(),
                     [&](const auto& each) { return each.test == test && each.alarm; });
}

double least_chance(const ValidationResult& result, ValidityTest test) {
  double least = 1;
  for (const auto& each : result.findings)
    if (each.test == test) least = std::fmin(least, each.p_value);
  return least;
}

/// A sentence on the tests of the whole sweep.
struct Unsteady {
  bool drifts, jumps;  // at most one of them is named
  bool follow;         // residuals of neighbours follow each other
  bool explained;      // the drift or jump is why they do

  [[nodiscard]] bool any() const { return drifts || jumps || follow; }
};

/// A change larger than the response itself is neither drift nor jump, but the trace of another fault.
Unsteady unsteady(const ValidationResult& result) {
  const bool drifts = (alarmed(result, ValidityTest::drift_even) || alarmed(result, ValidityTest::drift_periods)) &&
                      std::abs(result.drift) < 1;
  const bool jumps =
      alarmed(result, ValidityTest::step) && std::abs(result.step) < 1 &&
      least_chance(result, ValidityTest::step) <=
          std::fmin(least_chance(result, ValidityTest::drift_even), least_chance(result, ValidityTest::drift_periods));
  return {drifts, jumps, alarmed(result, ValidityTest::neighbours) || alarmed(result, ValidityTest::neighbourhoods),
          jumps ? result.step_explains : drifts && result.drift_explains};
}

/// The sentence's part on drift, jump and neighbours; empty where there is nothing to say.
std::string on_unsteadiness(const ValidationResult& result, const Unsteady& is) {
  const std::string drift = percent(result.drift) + " +- " + percent(result.drift_deviation) + " during the sweep";
  const auto frequency = [&](double omega) { return detail::short_text(in_unit(omega, result.frequency_unit)); };
  const std::string jump = percent(result.step) + " +- " + percent(result.step_deviation) + " between " +
                           frequency(result.step_below) + " and " + frequency(result.step_above) + " " +
                           std::string(to_string(result.frequency_unit));
  if (is.follow && !is.explained)
    return "residuals of neighbouring points follow each other (correlation " + detail::short_text(result.correlation) +
           " beyond that of white noise)" +
           (is.jumps    ? ", of which a jump by " + jump + " explains " + percent(result.step_share)
            : is.drifts ? ", of which a drift of " + drift + " explains " + percent(result.drift_share)
                        : "");
  if (is.jumps) return "the response jumps by " + jump;
  if (is.drifts) return "the response drifts by " + drift;
  return result.departs ? "what the points leave looks like a drift or jump larger than the response itself" : "";
}

/// All that was found, one after another; empty where nothing was.
std::string all_found(const ValidationResult& result, const Unsteady& is) {
  std::string all;
  const auto add = [&all](const std::string& part) {
    if (!part.empty()) all += (all.empty() ? "" : "; ") + part;
  };
  add(on_unsteadiness(result, is));
  if (!result.mains.empty())
    add(detail::counted(result.mains.size(), "point") + " at " +
        (alarmed(result, ValidityTest::mains_50) ? "50" : "60") + " Hz or a harmonic stand out");
  if (!result.outliers.empty()) add(detail::counted(result.outliers.size(), "outlier"));
  return all;
}

/// A sentence on departures that are significant but too small to matter.
std::string of_small_departures(const ValidationResult& result) {
  return "the points are consistent to " + percent(result.consistent_to) + ", within the " + percent(result.tolerance) +
         " that matter";
}

std::string of_valid_points(const ValidationResult& result, const std::string& found) {
  if (result.departs) return of_small_departures(result) + "; the rest is more than noise: " + found;
  const std::string text =
      "a linear, stable, steady system" +
      (result.dead_time > 0 ? " with a dead time of about " + detail::short_text(result.dead_time) + " s" : "") +
      " explains all points to within noise of " + percent(result.noise);
  if (std::any_of(result.findings.begin(), result.findings.end(), [&](const auto& each) {
        return !each.alarm && each.p_value < result.level * detail::share_of_level;
      }))
    return text + "; what it leaves is no noise, but within the accuracy of " + percent(result.accuracy);
  return text + "; a drift above " + percent(result.detectable_drift) + " would have been seen";
}

std::string of_suspect_points(const ValidationResult& result, const std::string& found) {
  if (result.departs) return found + "; but for single ones " + of_small_departures(result);
  return found + "; the other points are consistent to within noise of " + percent(result.noise);
}

std::string of_invalid_points(const ValidationResult& result, const std::string& found) {
  if (result.reversed_sign)
    return "the sign of the imaginary part looks reversed: with the other sign a linear, stable, steady system "
           "explains the points, and as they are none does";
  return found + "; no linear, stable, steady system explains the points to within noise of " + percent(result.noise) +
         ", " + percent(result.largest_residual) + " at most; they are consistent to " + percent(result.consistent_to) +
         " only";
}

std::string of_undecided_points(const ValidationResult& result, const Unsteady& is, const std::string& found) {
  if (is.any() && !found.empty() && !(result.consistent_to <= result.tolerance))
    return found + "; over less than an octave, echoes that the points are too far apart to resolve do that too";
  return "band, points and noise leave too little to judge by (" + detail::short_text(result.freedom) +
         " degrees of freedom" +
         (std::isfinite(result.detectable_drift)
              ? ", a drift of " + percent(result.detectable_drift) + " would go unseen"
              : "") +
         ")" + (found.empty() ? "" : "; " + found);
}

}  // namespace

std::string ValidationResult::summary() const {
  if (model.empty()) return "undecided: fewer than 6 points, or all at one frequency";
  const Unsteady is = unsteady(*this);
  const std::string found = all_found(*this, is);
  const std::string said = validity == Validity::valid     ? of_valid_points(*this, found)
                           : validity == Validity::suspect ? of_suspect_points(*this, found)
                           : validity == Validity::invalid ? of_invalid_points(*this, found)
                                                           : of_undecided_points(*this, is, found);
  return std::string(to_string(validity)) + (every > 1 ? " by one point in " + std::to_string(every) : "") + ": " +
         said;
}

}  // namespace frac
