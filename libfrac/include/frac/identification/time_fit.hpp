// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/time_response_data.hpp"

namespace frac {

/// Noise of a record: independent from sample to sample, or of first order, see TimeFitOptions::noise_correlation.
enum class RecordNoise { white, coloured };
[[nodiscard]] std::string_view to_string(RecordNoise noise);
[[nodiscard]] RecordNoise record_noise_from_string(std::string_view text);
[[nodiscard]] std::span<const RecordNoise> record_noises();

struct TimeFitOptions {
  std::vector<ParameterConstraint> constraints;
  /// What the output shows at rest: unset, it is estimated and stands last among the parameters, named "offset".
  std::optional<double> offset;
  /// A steady drift of the output is estimated too: it stands behind the offset, named "drift", per second from the
  /// first sample on.
  bool trend = false;
  /// The record may start in motion, by an input before it that nobody has recorded: unknown levels of the input up to
  /// the first sample, of which the last eighth and the last sixty-fourth of the record's length before it have their
  /// own, are estimated with the rest (FitResult::earlier_input).  For a record whose input never changes the level up
  /// to the first sample is not told from the gain, so it stays at rest.
  bool earlier_input = false;
  /// r of noise of first order, from 0 (white) to below 1: each value is the r-th part of the one a sample before and
  /// white noise.  Residuals are freed of that part and brought back to the size of the noise, so that least squares
  /// are the most likely parameters; cost, criteria and intervals are those of these residuals.
  double noise_correlation = 0;
  /// Coloured: where `noise_correlation` is 0, the most likely one beside the parameters is taken (restricted
  /// likelihood), from 0 to .999, and FitResult::noise_correlation tells it.  White: it is as told.  Unset: white for
  /// fit(), coloured for identify(), which takes one correlation for all candidates.
  std::optional<RecordNoise> noise = std::nullopt;
  Loss loss = Loss::none;
  std::optional<double> loss_scale;  // as in FitOptions
  std::uint64_t seed = 1;            // of the multi-start; same seed, same result
  bool global_start = true;  // false: one local solve from the given starts; every free parameter then needs one
};

/// Fits a structure, orders and dead time too, to samples of input and output: a ratio of sums of powers, or a formula
/// without dead time whose singularities lie on the negative real axis alone, as those of diffusion and relaxations do
/// (tanh(sqrt(T s))/sqrt(T s), 1/(1 + (T s)^a)^b).  Least squares of (model - output)/sigma, sigma of the data or one
/// unknown value.  The model is simulated exactly for the input as held, so that nothing is biased by the sampling;
/// start values come from a fit to the Laplace transforms of input and output over the record.  Data of more than 500
/// samples are first fitted at every n-th output, the input always in full.
/// Where the input does not change within the record and a constant of the model acts as the offset does, the offset
/// is held at 0, and the message says so.  Without `trend` and `earlier_input` the residuals are tested for both (F
/// test on residuals freed of the correlation of neighbours), and the message says what they show.
/// An output that its offset explains alone cannot be fitted (no_usable_start); one that it explains as well, in the
/// F test at 1 %, leaves every parameter of the model not identified.
/// Frequencies in the result (centre_omega, ranges of coefficients) are those the record resolves.
/// @throws std::invalid_argument  as fit(); a structure that is neither of these or has a parameter
/// "offset" or "drift"; an output outside 1e-140 to 1e140, whose sums of squares leave double precision.
[[nodiscard]] FitResult fit(const TimeResponseData& data, const Structure& structure,
                            const TimeFitOptions& options = {});

/// Output of the fitted model at the instants of the data, offset included.
[[nodiscard]] std::vector<double> fitted_output(const FitResult& result, const TimeResponseData& data,
                                                const TimeFitOptions& options = {});

}  // namespace frac
