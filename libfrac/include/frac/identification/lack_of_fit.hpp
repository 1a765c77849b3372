// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// What tells the noise that residuals are compared with.
enum class NoiseSource {
  sigma,    // the standard deviations given with the data (weight given, or a record over time with sigma)
  repeats,  // the scatter of values measured at the same frequency
  data,     // what the residuals change by from point to point: a model that misses a shape leaves smooth residuals
};
[[nodiscard]] std::string_view to_string(NoiseSource source);

/// Whether a fit follows the data to within their noise.
///
/// With sigma or repeats the residuals must not exceed the noise: chi-squared, or F against the scatter of repeats.
/// Always, and with NoiseSource::data alone, they must not follow each other along the axis: their correlation at lag
/// one and the Ljung-Box statistic, on residuals clipped at three robust standard deviations so that a single outlier
/// does not hide a shape.  A fit fails where either chance is below 1e-3.  Below ten points nothing can be told from
/// the data alone and the fit passes.  Over time the noise may be of first order, each value the r-th part of the one
/// before and white noise: residuals that are not white have to be so once that part is taken away.  Where the options
/// of the fit tell r, residuals freed of that correlation have to be white.
struct LackOfFit {
  NoiseSource source;
  double noise;                // standard deviation of a weighted residual as the source tells it
  double misfit;               // rms of the residuals, by degrees of freedom, over noise: 1 for a model that fits
  double p_value;              // chance of such a misfit by noise alone; NaN where only the data tell the noise
  double correlation;          // of neighbouring residuals
  double correlation_p_value;  // chance of so much correlation in white or first-order noise; NaN below ten points
  bool adequate;
  struct Band {
    double lower, upper;  // rad/s, or s over time
  };
  std::vector<Band> misses;  // where the mean of neighbouring residuals exceeds three times what noise makes of it
};

/// @param result  of a fit to these data with these options
[[nodiscard]] LackOfFit lack_of_fit(const FrequencyResponseData& data, const FitOptions& options,
                                    const FitResult& result);
[[nodiscard]] LackOfFit lack_of_fit(const TimeResponseData& data, const TimeFitOptions& options,
                                    const FitResult& result);

}  // namespace frac
