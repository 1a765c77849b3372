// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// Magnitude f below which the noise is additive: noise of standard deviation r sqrt(|G|^2 + f^2) explains best how the
/// residuals of a fit change from point to point.  What they change by is their distance from the line through both
/// neighbours, in which a smooth error of the model cancels; outliers count little (Student's t with 4 degrees).
/// @param model  of the fit, one value per point
/// @return 0 where noise relative to |G| everywhere is not clearly beaten
[[nodiscard]] double noise_floor(const FrequencyResponseData& data, std::span<const std::complex<double>> model,
                                 Component component);
/// The same without a model: what each value lies off the curve through its neighbours, which takes a bend of the
/// response between neighbouring points for noise.
[[nodiscard]] double noise_floor(const FrequencyResponseData& data, Component component);

}  // namespace frac::detail
