// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/time_fit.hpp"
#include "identification/data/fit_data.hpp"

namespace frac::detail {

/// Whether two correlations differ by less than half the standard deviation of an estimate from so many values.
[[nodiscard]] bool same_correlation(double one, double other, double count);

/// Correlation of noise of first order that is the most likely beside the parameters of a structure.
/// @param white  options of fits in white noise, with the constraints of the structure
/// @param fit    a usable one in any noise
[[nodiscard]] double likely_noise_correlation(const TimeResponseData& data, const TimeFitOptions& white,
                                              const FitResult& fit);

/// Two rounds of `make(options)`, which returns something with a fit to the data: in white noise, and in the noise that
/// is the most likely beside that fit.
/// @param fit_of      the fit in what was made
/// @param options_of  the options it was made with, of what was made and of those it was asked with
template <class Make, class FitOf, class OptionsOf>
auto made_in_likely_noise(const TimeResponseData& data, const TimeFitOptions& options, const Make& make,
                          const FitOf& fit_of, const OptionsOf& options_of) {
  const TimeFitOptions white = in_noise(options, 0);
  auto made = make(white);
  if (!fit_of(made).usable()) return made;
  const double r = likely_noise_correlation(data, options_of(made, white), fit_of(made));
  if (r > 0) made = make(in_noise(options, r));
  fit_of(made).noise_correlation = r;
  return made;
}

}  // namespace frac::detail
