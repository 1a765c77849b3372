// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// An interval that follows the cost itself instead of its curvature at the minimum.
struct ProfileInterval {
  double lower, upper;        // a side without end within the bounds of the parameter is -infinity or infinity
  bool better_minimum_found;  // a refit went below the cost of the result: that was no minimum
};

/// 95 % interval of one parameter: where the least cost with the parameter held there exceeds the minimum by the factor
/// 1 + t^2/(n - k) (Venzon, Moolgavkar 1988; t of Student with n - k degrees of freedom, times the widening of the
/// parameter).  With a robust loss, whose scale stays that of the result: where the loss exceeds its minimum by
/// t^2 FitResult::loss_unit.
/// @param result  of fit() on the same data with the same options
/// @throws std::invalid_argument  an unknown, fixed or unseen parameter, or no degree of freedom left.
[[nodiscard]] ProfileInterval profile_interval(const FrequencyResponseData& data, const FitOptions& options,
                                               const FitResult& result, std::string_view parameter);
[[nodiscard]] ProfileInterval profile_interval(const TimeResponseData& data, const TimeFitOptions& options,
                                               const FitResult& result, std::string_view parameter);

/// Percentiles of refits to resampled residuals.
struct BootstrapInterval {
  double lower, upper;    // 2.5 % and 97.5 %
  double standard_error;  // standard deviation of the refits; 0 when fixed
};

/// Residual bootstrap (Efron, Tibshirani 1993, sect. 9.4): the complex residuals, relative to the model (relative,
/// smoothed, log-complex weight and repeats), to sigma (given) or as they are (absolute), are centred (Freedman 1981;
/// not under a robust loss), drawn with replacement, added to the fitted curve and fitted again from the result.  Where
/// neighbours go together (FitResult::noise_correlation) what each adds to the share of the one before is drawn, and
/// put together again.  In a fit of one part only that part is resampled.  The same seed gives the same intervals for
/// any number of threads.
/// @return one interval per parameter
/// @throws std::invalid_argument  fewer than 20 samples.
[[nodiscard]] std::vector<BootstrapInterval> bootstrap(const FrequencyResponseData& data, const FitOptions& options,
                                                       const FitResult& result, std::size_t samples, int threads = 0);
/// The same over time, with the residuals relative to sigma, or as they are without one.
[[nodiscard]] std::vector<BootstrapInterval> bootstrap(const TimeResponseData& data, const TimeFitOptions& options,
                                                       const FitResult& result, std::size_t samples, int threads = 0);

/// The refits of such a bootstrap one by one, in any order: for studies that have to survive an interruption.
class BootstrapRefits {
 public:
  /// @param data  has to outlive this
  BootstrapRefits(const FrequencyResponseData& data, const FitOptions& options, const FitResult& result);
  BootstrapRefits(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& result);
  /// Parameters of the refit of a sample; safe to call from several threads.
  [[nodiscard]] std::vector<double> parameters(std::size_t sample) const { return refit_(sample); }

 private:
  std::function<std::vector<double>(std::size_t)> refit_;
};

/// Percentiles of the parameters of refits, one interval per parameter.
/// @throws std::invalid_argument  fewer than 20 refits.
[[nodiscard]] std::vector<BootstrapInterval> bootstrap_intervals(const std::vector<std::vector<double>>& refits);

/// Standard deviation of the fitted curve, from the covariance of the parameters (those without a standard error held);
/// NaN where these only trade off, so that no digit of the curve's own is left in their covariance.
struct ResponseDeviation {
  double real, imaginary;  // unit of the data
  double log_magnitude;    // of ln|G|
  double phase;            // rad
};
[[nodiscard]] std::vector<ResponseDeviation> response_deviation(const FitResult& result, const Realisation& realisation,
                                                                const std::vector<double>& omega);

}  // namespace frac
