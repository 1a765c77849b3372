// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "frac/structure.hpp"

namespace frac {

/// One of the curves that are fitted together: a frequency response, or samples of input and output.
struct JointCurve {
  std::string name;  // for messages and results
  std::variant<FrequencyResponseData, TimeResponseData> data;
  std::vector<std::pair<std::string, double>> covariates = {};  // what is known of it beside: a temperature, a load

  /// Null where it is the other one.
  [[nodiscard]] const FrequencyResponseData* response() const { return std::get_if<FrequencyResponseData>(&data); }
  [[nodiscard]] const TimeResponseData* record() const { return std::get_if<TimeResponseData>(&data); }
};

/// Curves that lie on one master curve once their frequencies are multiplied (time-temperature superposition):
/// G(j omega) = bT M(j aT omega) with M the structure, and aT and bT parameters of each curve, 1 for the reference.
struct CurveShift {
  std::size_t reference = 0;  // index of the curve
  bool vertical = false;      // whether there is bT, or else 1
};
inline constexpr const char* horizontal_shift = "aT";
inline constexpr const char* vertical_shift = "bT";

/// bT M(aT s) of a structure M(s); without bT where the shift is horizontal alone.
/// @throws std::invalid_argument  the structure has a parameter of these names.
[[nodiscard]] Structure shifted(const Structure& master, const CurveShift& shift);

struct JointFitOptions {
  /// Component, weight, loss, realisation, seed and constraints, which hold in every curve.  A prior of a parameter of
  /// which each curve has its own counts in each of them.
  FitOptions fit;
  /// Parameters that all curves have in common; of the others each curve has its own.
  std::vector<std::string> shared;
  /// Parameters that follow a law of covariates, "K = K0 T^p" or "T = T0 exp(E/(8.314 temperature))": names that no
  /// curve knows as covariates are parameters of the laws, which all curves have in common and which may stand in
  /// several laws.  They are free of limits but for the constraints given by their names; a factor of all its laws is
  /// fitted by its logarithm where it starts above 0.  Of constraints on a parameter that follows a law only the start
  /// is used.
  std::vector<std::string> laws;
  /// Adds aT, and bT where wanted, to the parameters of each curve; they may follow laws.  Neighbours in the list
  /// should overlap: starts come from laying each on the one before it.  Where aT follows a law, the law says which
  /// curve is the master curve itself, whatever the reference.
  std::optional<CurveShift> shift = {};
  /// Offset, trend and earlier input of curves over time, which each has of its own; all else is told by `fit`.
  TimeFitOptions over_time = {};
  int threads = 0;  // 0: one per core; without influence on the result
};

struct JointCurveResult {
  std::string name;
  /// All parameters of the formula, the shared ones too, as they hold for this curve.
  std::vector<ParameterEstimate> parameters;
  std::vector<std::vector<double>> covariance;  // of them, as FitResult::covariance
  /// The same of them and then of the parameters of the laws, which stand last in JointFitResult::shared.
  std::vector<std::vector<double>> covariance_with_laws;
  std::size_t residuals;                   // count
  double rms, max_residual;                // weighted as in fit()
  double rms_alone;                        // of the fit of this curve alone; NaN where it has none
  double noise;                            // standard deviation of a residual by which the curve counts
  std::vector<PriorEstimate> priors = {};  // of parameters that are its own
};

/// One structure fitted to many curves at once.
struct JointFitResult {
  [[nodiscard]] bool usable() const noexcept { return termination == FitTermination::converged; }
  /// Formula, shared parameters with their 95 % intervals, and what became of the search.
  [[nodiscard]] std::string summary() const;

  std::string model;                      // the formula, with aT and bT where there are any
  std::vector<ParameterEstimate> shared;  // and those of the laws
  std::vector<JointCurveResult> curves;
  double cost;       // sum of squares of the residuals, each divided by the noise of its curve
  double loss_cost;  // sum of the loss over the points, in the same unit; the cost where there is none
  FitTermination termination;
  std::string message;                     // one or a few sentences
  std::size_t residuals, free_parameters;  // counts over all curves
  std::size_t starts, starts_at_best;      // joint searches, and how many of them ended at the least cost
  /// Chance that curves which do share these parameters ask for separate ones as strongly as these do (F test of the
  /// joint fit against the fits alone, white noise taken for granted): small where the curves do not share them.  NaN
  /// where a curve has no fit of its own, or where nothing is left to compare.  Where shift factors follow laws, the
  /// same of these laws against a factor of each curve, without loss and priors.
  double sharing_p_value;
  double condition;   // of the scaled Fisher matrix of the shared parameters, the others fitted along
  double half_width;  // of a 95 % interval in standard errors (Student's t)
  double seconds;
  std::vector<PriorEstimate> priors = {};  // of shared parameters and of those of the laws
  /// Parameters that the residuals tell: all free ones but for the shares that priors tell.
  double effective_parameters = 0;
  bool without_noise = false;  // of all curves, see FitResult::without_noise
};

/// Fits one structure to several curves with shared parameters and parameters of each curve.
///
/// Each curve is fitted alone first, which gives starts and noise; then all parameters are refined together from a few
/// starts (Ceres, with the parameters of the curves eliminated, so that the time grows in proportion to their number).
/// Curves count by their noise as their own fits leave it, drawn towards the common level as far as the levels differ
/// no more than chance makes them (Smyth 2004); with weight `given` and `repeats` as the weight says.  A robust loss
/// has a scale of its own in each curve, that of its fit alone.  Fits alone know no priors.  Intervals come from the
/// full covariance and allow for correlated neighbours as those of fit(); those of parameters fitted by their logarithm
/// are even in the logarithm. With a shift no curve is fitted alone: each is laid on its neighbour, the structure
/// fitted to all of them as one curve, and the noise told by what each leaves; a weight that is learned is learned with
/// the curves where the joint fit lays them, so that their order tells nothing.
/// @throws std::invalid_argument  as fit(); no curve; a shared name that is unknown, repeated or fixed, or none beside
///     neither law nor shift; an order of parameters of which the greater one is shared and the lesser one is not, or
///     one is of a law; a prior of a parameter that follows a law; with a shift weight `repeats`, a reference that is
///     no curve, or a structure that has a parameter aT or bT; a law of no parameter of the model, of a shared one, of
///     one that has a law, without a covariate, or with one that a curve does not know; a parameter of a law fixed;
///     a shift of a curve over time, or weight `given` for one without sigma;
///     fewer residuals than parameters; or no curve that determines all parameters alone, unless all have starts.
[[nodiscard]] JointFitResult joint_fit(const std::vector<JointCurve>& curves, const Structure& structure,
                                       const JointFitOptions& options);

}  // namespace frac
