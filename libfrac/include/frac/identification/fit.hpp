// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/model/frequency_response_data.hpp"
#include "frac/realisation.hpp"
#include "frac/structure.hpp"

namespace frac {

/// Part of G(j omega) that forms the residual.
enum class Component { imaginary, real, both, magnitude, phase };
/// What a residual is divided by.  Magnitude and phase residuals are never divided by |data|: the relative magnitude
/// residual is ln|model/data|, the phase residual an angle in rad (times |data|/sigma where the noise is known).
enum class Weight {
  relative,           // |data|; a value of 0 weighs like the smallest other one, below which nothing was told
  absolute,           // nothing
  given,              // the sigma of the data
  smoothed_relative,  // |data| as up to eight neighbours tell it: noise in |data| does not bias the fit
  /// Residuals are ln|model/data| and the angle from data to model (component both, magnitude, phase).
  log_complex,
  repeats,  // the standard deviation of repeats at each frequency, pooled over five frequencies
  /// sqrt(|data|^2 + floor^2): relative where the data are larger than the floor, absolute below it.  Magnitude and
  /// phase know no floor and are taken as under relative.
  learned,
};
/// Robust loss on each residual, scaled by its own estimate of spread.
enum class Loss { none, huber, cauchy };

/// Command-line spellings.  from_string throws std::invalid_argument naming the allowed ones.
[[nodiscard]] std::string_view to_string(Component component);
[[nodiscard]] std::string_view to_string(Weight weight);
[[nodiscard]] std::string_view to_string(Loss loss);
[[nodiscard]] Component component_from_string(std::string_view text);
[[nodiscard]] Weight weight_from_string(std::string_view text);
[[nodiscard]] Loss loss_from_string(std::string_view text);
[[nodiscard]] std::span<const Component> components();
[[nodiscard]] std::span<const Weight> weights();
[[nodiscard]] std::span<const Loss> losses();

/// A normal distribution that a parameter comes from, by what is known beside the data.  It counts as one more datum:
/// its square (parameter - value)^2/deviation^2 adds to those of the residuals in units of the noise, which the
/// residuals tell.
struct ParameterPrior {
  double value;
  double deviation;       // standard deviation, > 0
  bool relative = false;  // of ln(parameter/value), as the share of the value that is meant by "10 +- 5 %"

  /// Distance of a parameter from the value in standard deviations; NaN where there is no logarithm.
  [[nodiscard]] double distance(double parameter) const;
  /// Its derivative by the parameter.
  [[nodiscard]] double slope(double parameter) const;
};

/// What is known of one parameter beforehand.  Unset limits take the defaults of its role: a coefficient that
/// Structure::parameter_keeps_sign() names is positive (fitted as its logarithm) unless a lower limit is given, any
/// other, a gain, has either sign (but the outer one in a fit of magnitudes), an order lies in [0, 4], or [-4, 4] when
/// it stands in no sum or in an added K s^a, a delay in [0, 2 pi/lowest omega], up to pi/(least distance of two omega).
struct ParameterConstraint {
  std::string name;
  std::optional<double> fixed;
  std::optional<double> lower;  // -infinity: free of sign
  std::optional<double> upper;
  std::optional<double> start;  // used by the first starts of a global search, and by a local one
  std::optional<ParameterPrior> prior = {};
  /// Another parameter of the same role and sign that it is not below; none where empty.
  std::string above = {};
  /// A gain that is positive too, fitted as its logarithm, unless a lower limit is given.
  bool positive = false;
};

/// What is known of the system before the data are seen.  What is left open holds unless the data speak against it:
/// then it is dropped, and the answer says so.
struct Assumptions {
  /// No pole right of the imaginary axis; integrators and undamped modes are allowed.  true: whatever the data say;
  /// false: nothing is assumed.  Unset: assumed.
  std::optional<bool> stable;
  /// true: a dead time is as likely as none.  false: no model has one.  Unset: it pays for its parameter.
  std::optional<bool> dead_time;
  /// The response is an immittance of a passive system: its real part is nowhere negative.  Models that keep to it are
  /// preferred, and it is said of the one chosen.
  bool passive = false;
};

struct FitOptions {
  Component component = Component::both;
  Weight weight = Weight::learned;
  Loss loss = Loss::none;
  /// Floor of weight `learned`, in the unit of the data, >= 0; unset: told by how the residuals change from point to
  /// point, 0 unless the data speak clearly for one, or where they are computed.
  std::optional<double> noise_floor;
  /// Weighted residual at which the loss turns from quadratic to robust; unset: from the spread of the residuals.
  std::optional<double> loss_scale;
  Realisation realisation = ExactRealisation{};
  std::vector<ParameterConstraint> constraints;
  Assumptions assumptions;
  bool without_noise = false;  // the data are computed, see FitResult::without_noise
  std::uint64_t seed = 1;      // of the multi-start; same seed, same result
  bool global_start = true;    // false: one local solve from the given starts; every free parameter then needs one
};

/// What front ends fit where `wanted` was asked for: the imaginary part instead of both, where the real part is 0 at
/// every frequency and so no part of the data.  An imaginary part of 0 is no such gap: every response without losses
/// has one.
[[nodiscard]] Component fitted_component(const FrequencyResponseData& data, Component wanted);
/// What they say then.
inline constexpr std::string_view imaginary_part_alone =
    "the real part is 0 at every frequency, so that the imaginary part alone is fitted";

/// What an interval follows: the curvature of the cost at its minimum, or the cost itself, as profile_interval() does.
enum class IntervalKind { curvature, profile };
[[nodiscard]] std::string_view to_string(IntervalKind kind);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] IntervalKind interval_kind_from_string(std::string_view text);

struct ParameterEstimate {
  std::string name;
  double value;
  /// From the residual variance and the correlation of neighbouring residuals; 0 when fixed, NaN when unseen or at a
  /// bound.
  double standard_error;
  /// Student t.  NaN like standard_error; a profile that has no end within the limits of the parameter ends at a limit.
  double ci95_lower, ci95_upper;
  bool fixed;
  bool at_bound;
  /// False at a bound, where the interval exceeds 50 % of the value, and for a part of a flat direction (condition of
  /// the Fisher matrix above 1e6).
  bool identified;
  /// With frequency in units of the band's geometric middle (T becomes T omega_c^a), where a coefficient is least
  /// correlated with the orders.
  double centre_value, centre_standard_error;
  /// The fitted component does not depend on it; it is estimated from the other one, with the rest held.
  bool from_other_component;
  /// profile where the interval is wider than 10 % of the value on a side, the fit has no loss and no flat direction.
  IntervalKind interval = IntervalKind::curvature;
  /// Factor that the correlation of neighbouring residuals has put on the standard error and the interval: about 1 for
  /// noise without, sqrt((1 + r)/(1 - r)) for a parameter that many points tell and noise of correlation r.
  double widening = 1;
  /// That were in force, given or by default; -infinity, infinity: none.  A positive coefficient has 0 and infinity.
  double lower_limit = -std::numeric_limits<double>::infinity();
  double upper_limit = std::numeric_limits<double>::infinity();
  bool limits_given = false;  // by a constraint, not by default
};

/// What would help against something that a message says.
enum class Remedy {
  give_limits,             // for parameters that ended at a limit nobody has given
  estimate_trend,          // TimeFitOptions::trend
  estimate_earlier_input,  // TimeFitOptions::earlier_input
  hold_zero_order,         // TimeResponseData::hold()
  hold_first_order,
  hold_band_limited
};
[[nodiscard]] std::string_view to_string(Remedy remedy);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] Remedy remedy_from_string(std::string_view text);
/// As a value, which each front end says in the words of its own options.
struct Advice {
  Remedy remedy;
  std::vector<std::string> parameters = {};  // concerned, of give_limits
};

/// What became of a prior in a fit.
struct PriorEstimate {
  std::string name;  // of the parameter
  ParameterPrior prior;
  double distance;  // of the estimate from the value, in standard deviations of the prior, with its sign
  /// Distance between what the prior and what everything else says, in standard deviations of that difference: a
  /// standard normal number where both are right.  NaN where nothing else speaks of the parameter.
  double conflict;
  double share;  // of what is known of the parameter, 0 to 1, that the prior has told
};

enum class FitTermination {
  converged,
  not_converged,    // best point found so far is returned
  no_usable_start,  // the model is not finite anywhere it was tried, or the fitted part of the data is 0 everywhere
};
[[nodiscard]] std::string_view to_string(FitTermination termination);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] FitTermination fit_termination_from_string(std::string_view text);

/// What is said in place of intervals and odds of data without noise.
inline constexpr std::string_view no_noise_sentence =
    "These data carry no noise: what counts is how many parameters buy which error.";

/// One structure fitted to data.  cost is the plain sum of squared (weighted) residuals, without the loss and without
/// priors.
struct FitResult {
  /// Converged.  Every result with a judgement of its own has usable(), which is true where it is what was asked for,
  /// and summary(), a few plain lines for a person.
  [[nodiscard]] bool usable() const noexcept { return termination == FitTermination::converged; }
  /// Formula, parameters with their 95 % intervals, rms residual and what became of the search.
  [[nodiscard]] std::string summary() const;

  std::string model;  // the formula
  std::vector<ParameterEstimate> parameters;
  double cost;
  double rms;           // sqrt(cost / residual count)
  double max_residual;  // largest |weighted residual|
  /// rms over that of the data, both parts, under the same weights: fits of one record with different weights compare
  /// by it.
  double relative_rms = std::numeric_limits<double>::quiet_NaN();
  /// Of the data: a parameter with a prior counts by the share of it that the residuals tell.
  double aicc;
  double bic;
  FitTermination termination;
  std::string message;          // one sentence
  std::size_t residuals;        // count
  std::size_t free_parameters;  // count
  std::size_t starts;           // local solves made
  std::size_t starts_at_best;   // of which ended at the best cost
  std::size_t distinct_minima;  // different ends of the seeded starts, those beyond 1.5 times the best cost as one
  /// Probability that no start whatever would have ended lower, from how often the seeded starts ended alike (Boender,
  /// Rinnooy Kan 1987; nothing is assumed of the number of minima and of the reach of each): 1 - distinct_minima/(n -
  /// 1) with n seeded starts.  1 where the fit is exact, NaN after a local solve.
  double confidence_of_optimum;
  double condition;                   // of the scaled Fisher matrix
  std::vector<std::size_t> outliers;  // data points whose residual exceeds 5 robust standard deviations
  /// Covariance of the estimates, one row per parameter: NaN beside one without standard error, 0 beside a fixed one.
  std::vector<std::vector<double>> covariance;
  double centre_omega;  // geometric middle of the band, rad/s
  double loss_cost;     // sum of the loss over the points: what was made least, and cost itself without a loss
  double loss_scale;    // that was used; NaN without a loss
  /// What loss_cost rises by, on average, for each parameter without meaning: cost/(residuals - parameters) without a
  /// loss, with one sum psi^2/(residuals - parameters)/mean psi' (Huber 1981, sect. 7.10).
  double loss_unit;
  double seconds;
  /// By which the fitted response is to be multiplied to undo the bias that noise in the divisor |data| causes under
  /// relative weight, 1 + 2 r^2 with r the spread of the residuals; 1 where that is below 0.05 or neighbours are alike.
  double gain_factor = 1;
  /// Over time with TimeFitOptions::earlier_input: steps of the input before the record, an eighth and a sixty-fourth
  /// of its length before the first sample and there; the last is missing where the input never changes.
  std::vector<double> earlier_input = {};
  double noise_floor = 0;  // of weight `learned`, in the unit of the data; 0 without one
  /// Correlation of neighbouring values of the noise, or of a smooth error of the model, that the intervals allow for:
  /// the mean over what the residuals leave possible, noise without any (0) included.  NaN where nothing was fitted.
  double noise_correlation = 0;
  /// Root mean square of the part of the residuals that goes smoothly along ln omega, by an error of the data
  /// (cables, calibration, drift) or of the model, in the unit of rms; the intervals allow for it.  The mean over what
  /// the residuals leave possible; 0 over time, NaN where nothing was fitted.
  double smooth_error = 0;
  /// Parameters that the residuals tell: all free ones but for the shares that priors tell.
  double effective_parameters = 0;
  /// The data carry no noise: the options say so, or fewer parameters than residuals meet them to 1e-9, which nothing
  /// measured allows.  What is left is the error of the model, so that intervals, criteria of evidence and
  /// `identified` say nothing of chance.
  bool without_noise = false;
  std::vector<PriorEstimate> priors = {};  // in the order of the parameters
  std::vector<Advice> advice = {};         // what would help against what the message says
};

/// Fits one structure: starts by linear least squares where the structure allows it, data-driven and seeded starts,
/// Ceres for each, NLopt when they disagree.  Interchangeable parts get their labels in a fixed order (arcs by rising
/// time constant, single powers by rising order), unless the constraints tell them apart.
///
/// Where an order of parameters (ParameterConstraint::above) is in force, the greater of the two is at its bound: it
/// equals the other one and has no interval of its own, and the intervals of the others take the two as equal.
/// @throws std::invalid_argument  an unknown or contradictory constraint; an order of parameters that goes in a circle,
///     compares unlike parameters or meets a lower limit of the greater one; a prior of a fixed parameter, without a
///     positive deviation, or a relative one of a value or parameter that is not positive; fewer residuals than free
///     parameters; weight `given` without sigma or `repeats` without repeats; a formula without s that has an order or
///     a parameter named like a frequency (p, S ...), or with j w; data that are 0 everywhere under relative weight
///     or `learned`; a value of 0 under log-complex weight or smoothed-relative, or for a phase; log-complex weight for
///     one part; frequencies the realisation cannot cover.
[[nodiscard]] FitResult fit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options);

/// Model values at the estimated parameters.
[[nodiscard]] std::vector<std::complex<double>> fitted_response(const FitResult& result, const Realisation& realisation,
                                                                const std::vector<double>& omega);

}  // namespace frac
