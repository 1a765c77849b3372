// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/time_response_data.hpp"

namespace frac {

struct TimeFitOptions {
  std::vector<ParameterConstraint> constraints;
  /// What the output shows at rest: unset, it is estimated and stands last among the parameters, named "offset".
  std::optional<double> offset;
  Loss loss = Loss::none;
  std::optional<double> loss_scale;  // as in FitOptions
  std::uint64_t seed = 1;            // of the multi-start; same seed, same result
  bool global_start = true;  // false: one local solve from the given starts; every free parameter then needs one
};

/// Fits a structure that reduces to a FractionalTransferFunction, orders and dead time too, to samples of input and
/// output: least squares of (model - output)/sigma, sigma of the data or one unknown value.  The model is simulated
/// exactly for the input as held, so that nothing is biased by the sampling; start values come from a fit to the
/// Laplace transforms of input and output over the record.  Data of more than 500 samples are first fitted at every
/// n-th output, the input always in full.
/// An output that its offset explains alone cannot be fitted (no_usable_start); one that it explains as well, in the
/// F test at 1 %, leaves every parameter of the model not identified.
/// Frequencies in the result (centre_omega, ranges of coefficients) are those the record resolves.
/// @throws std::invalid_argument  as fit(); a structure that is no ratio of sums of powers or has a parameter "offset".
[[nodiscard]] FitResult fit(const TimeResponseData& data, const Structure& structure,
                            const TimeFitOptions& options = {});

/// Output of the fitted model at the instants of the data, offset included.
[[nodiscard]] std::vector<double> fitted_output(const FitResult& result, const TimeResponseData& data,
                                                const TimeFitOptions& options = {});

}  // namespace frac
