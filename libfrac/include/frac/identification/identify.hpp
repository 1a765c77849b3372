// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/lack_of_fit.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// A model given by its values at the frequencies of the data, e.g. the static-backlash curve.
struct FixedCurve {
  std::string name;
  std::vector<std::complex<double>> value;
  std::size_t fitted_parameters = 0;  // that were adjusted to these data elsewhere and are charged in AICc and BIC
};

struct RankedFit {
  std::string name;
  ModelClass model_class;
  FitResult fit;
  double delta_aicc;         // aicc minus the best one; 0 for the best
  double akaike_weight;      // share of evidence among the ranked; they sum to 1
  NamedModel model;          // as fitted: formula and constraints; a given curve has only its name
  LackOfFit lack_of_fit;     // whether it follows the data to within their noise
  bool from_family = false;  // the member of a family that the data chose
  /// Names of candidates that came to the same model in another spelling: as many parameters and the same response, on
  /// the data and a decade beyond.  They are listed and counted once.
  std::vector<std::string> also;
};

enum class Verdict {
  fractional_supported,
  fractional_or_distribution,
  fractional_not_supported,
  undecided,
  no_adequate_model
};
[[nodiscard]] std::string_view to_string(Verdict verdict);
/// Whether whole orders do not explain the data.
[[nodiscard]] constexpr bool refuses_whole_orders(Verdict verdict) {
  return verdict == Verdict::fractional_supported || verdict == Verdict::fractional_or_distribution;
}

/// One of the two models a verdict compares.
struct Finalist {
  std::size_t index;       // into ranking
  std::size_t parameters;  // adjusted to the data
  /// rms of the weighted residuals with which fits to the rest predict blocks of neighbouring points, the two ends
  /// among them; NaN where no verdict asked for it.
  double prediction_rms;
  /// The same for half a decade at either end of the band, which the rest is extrapolated to; NaN over time, and where
  /// that would take more than a third of the points.
  double extrapolation_rms;
};

/// A measurement that would decide between two models.
struct NextMeasurement {
  double lower, upper;       // rad/s: half a decade
  std::size_t points;        // even in the logarithm
  double accuracy;           // standard deviation of their weighted residuals
  double relative_accuracy;  // the same as a share of the response in the middle of the band
  double expected_evidence;  // by which evidence is expected to change, in favour of the true one of the two
};

/// Up to three sums of lags g/(1 + s t) whose times t are spread about a centre, with ln t normal or even between two
/// ends, and a constant, s and 1/s where they pay: what else than a fractional power bends a response over decades.
struct DistributionRival {
  std::string model;       // in words, times in s
  std::size_t parameters;  // adjusted to the data
  double relative_rms;     // of the weighted residuals, over that of the weighted data
  double evidence;         // of the fractional finalist against it, as IdentificationResult::evidence
};

/// Structures ranked by AICc on the same residuals, best first.  The chosen one is, of those that follow the data (all,
/// if none does) and whose fit converged, the simplest with an AICc within 2 of the best; where the verdict speaks for
/// the other class than its own, the finalist of that class, and where it is undecided the finalist of greater
/// evidence, if that follows the data with fewer parameters.  One that is unstable, or has a dead time or a negative
/// real part, against the FitOptions::assumptions, is set aside for the best of its class that keeps to them, unless
/// the data speak against that one.  The verdict compares candidates whatever is assumed of poles.
///
/// The verdict compares the best fractional with the best integer-order or given candidate among those that follow the
/// data to within their noise, see LackOfFit.  "Best" is least n ln(cost/n) + k n ln n/(n - k - 2) with n residuals and
/// k parameters, Schwarz's criterion with the correction for few residuals (McQuarrie 1999).  Where noise with heavy
/// tails (Student's distribution, four degrees of freedom) explains the residuals of a candidate better than normal
/// noise, its likelihood stands for n ln(cost/n): no model is refuted by a few points that another goes out of its way
/// for.  A family of nested or nearly equal members takes part with one of them, so that their number is no evidence.
/// A candidate that fails its test with a chance p counts as one that follows the data where p > 1e-3 exp(-E/2) and E
/// is what its criterion is better by than all that pass: both are accidents, and the lesser one is taken.
///
/// Evidence is the difference of this, integer-order minus fractional: twice the logarithm of the posterior odds of the
/// two models to Schwarz's approximation.  It assumes equal odds beforehand and independent residuals.  Where the
/// residuals of the better one follow each other (lag-one correlation r above 0), n is the number of points that carry
/// news, n (1 - r)/(1 + r).
///
/// Over time the noise may be of first order (TimeFitOptions::noise_correlation).  Its r is the most likely one beside
/// the candidate that is the most likely in such noise, each priced for its parameters, and 0 where that one leaves
/// white residuals.  All candidates are fitted, tested and compared in that noise.  A shape that all candidates miss
/// may pass for slow noise.  So where a class is told in correlated noise, or a fractional order supported, and no
/// family of ratios in s is among the candidates, one is grown beside them and all is judged anew.
///
/// An order departs where it lies 0.1 or more from every whole number.  Departure evidence is that of the best
/// candidate with such an order, members that a family did not choose and the finalist with an order moved so far among
/// them.  What departs has to show, too.  s^0.1 turns the phase by 0.1 pi/2, and by as much, as a share of it, some
/// value has to differ from what an integer-order candidate gives it that the fractional one contains, as a diffusion
/// behind a lag contains the lag.  That holds where Schwarz's criterion prefers the integer-order one of these two, and
/// for formulas whose orders are written as numbers as for others, members of families left out.
///
/// supported      evidence above 10 (over time above 20), also beside a smooth error, cross-validation not
///                worse by more than a twentieth and extrapolation not by more than a quarter, an order whose interval
///                (widened by the correlation) excludes every whole number while not every order lies within 0.02 of
///                one, and no integer-order candidate that could not be fitted.
/// fractional or
/// distribution   the same, but distributed relaxation times (DistributionRival) follow the data as well or better:
///                evidence against them is not above 10.
/// not supported  an integer-order candidate follows the data, no more poles might improve it (see
///                NamedModel::ends_its_family), nor do residuals below 1e-4 of the data fall evenly from pole to pole,
///                and it predicts not worse by more than a twentieth, extrapolates not by more than a half (both a half
///                where the fractional finalist has whole orders).  Departure evidence is below -8 (beside a smooth
///                error not above 0), and by 16 more for each stable real pole and dead time of a ratio beyond two,
///                because rows of these approximate fractional systems, also such as are among no candidates; evidence
///                is below 2, or each order within 0.02 of a whole number.  Or both meet the data to rounding, and the
///                integer-order one has no more parameters.  Where the integer-order one is the member of a family and
///                no fractional family could grow, as over time, it may have no more parameters than the fractional
///                one.  Half a decade at the ends is missed by no more than a hundred times the residuals.
/// undecided      anything else, with the next measurement that would decide.  So where one value in twenty repeats its
///                neighbour's, as by coarse rounding, and the better one has more parameters: it may follow the steps.
///
/// A response of which both parts are fitted and that validate() calls invalid supports no fractional order: undecided.
///
/// Where no candidate follows the data to within their noise, what is left is model error, as of computed data, whose
/// noise is rounding, or of careful measurements.  The same rules then compare the two that come closest, since their
/// evidence counts smooth residuals as few; but the winner must come within 5 % of the data (rms), or the verdict is
/// no_adequate_model.
struct IdentificationResult {
  /// The fit of the chosen candidate converged.
  [[nodiscard]] bool usable() const { return ranking.at(chosen).fit.usable(); }
  /// The verdict, unless the data carry no noise, and the chosen fit.
  [[nodiscard]] std::string summary() const;
  /// As one of the fits says: economy() answers then, and neither odds nor intervals mean anything.
  [[nodiscard]] bool without_noise() const;

  std::vector<RankedFit> ranking;
  std::vector<std::string> skipped;  // candidates that could not be fitted, with the reason
  std::size_t chosen;                // index into ranking
  Verdict verdict;
  double evidence;  // NaN when one side has no candidate
  /// Evidence for the best fractional candidate, members that its family had not chosen among them, with an order at
  /// least 0.1 from every whole number, where it shows.
  double departure_evidence;
  /// Both where the data may hold a smooth error of usual size besides their noise, 1 % of the response or ten times
  /// what the closest candidate leaves: models that spend parameters on following it gain nothing by that.  Of all
  /// candidates; NaN over time.
  double evidence_beside_smooth_error, departure_beside_smooth_error;
  std::string verdict_sentence;         // at most some 35 words
  std::vector<std::string> notes = {};  // what else is to be known of the verdict and of the choice, a sentence each
  /// Index into ranking of the candidate that would have been chosen but for the assumptions.
  std::optional<std::size_t> set_aside;
  std::vector<Advice> advice = {};              // what would help against what the sentence says
  std::optional<Finalist> fractional, integer;  // what was compared; unset where the class has no candidate
  /// What a fractional order that whole orders do not replace was compared with; unset otherwise, and over time.
  std::optional<DistributionRival> distribution = {};
  /// Decimal logarithm of the odds of fractional to integer order, equal before.  Evidence alone would give
  /// evidence/(2 ln 10), and departure evidence takes its place where the fractional finalist has whole orders or
  /// the verdict is not-supported against evidence above 0; it compares two models, and with a probability of 0.05, or
  /// 0.5 where the verdict is left open because other rules speak against it, both are taken to be far from what made
  /// the data.  So no odds exceed 39, or 3, to 1.
  double log10_odds;
  /// Where within a decade outside the data the two finalists differ most, relative to the integer-order one: a
  /// measurement there tells them apart.  NaN where there are not both, and over time.
  double differ_most_omega, differ_most;
  bool model_error = false;             // no candidate follows the data to within their noise
  std::optional<NextMeasurement> next;  // where undecided between two models of a frequency response
  /// Over time: r of TimeFitOptions::noise_correlation that all candidates were fitted with.
  double noise_correlation = 0;
  /// Floor of weight `learned` that all candidates were fitted with, in the unit of the data; 0 under other weights.
  double noise_floor = 0;
};

/// None of the candidates could be fitted; what() gives the reason of the first.
class NoCandidateFits : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws std::invalid_argument  no candidate, a curve of another length than the data, or a weight that does not go
///     with the data (see fit()).
/// @throws NoCandidateFits
[[nodiscard]] IdentificationResult identify(const FrequencyResponseData& data, const std::vector<NamedModel>& models,
                                            const std::vector<FixedCurve>& curves, const FitOptions& options,
                                            int threads = 0);
/// The same on samples of input and output.  A candidate that no fit over time takes is skipped, and so is one without
/// a finite response to the input, such as a differentiator under a step.
[[nodiscard]] IdentificationResult identify(const TimeResponseData& data, const std::vector<NamedModel>& models,
                                            const TimeFitOptions& options, int threads = 0);

}  // namespace frac
