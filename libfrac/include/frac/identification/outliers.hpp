// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace frac {

/// Points of a frequency response that both sides contradict: indices, increasing.
///
/// A point, or two or three of six neighbours together, is one where it lies off the curve through the two points on
/// either side (cubic in the logarithm of frequency) by more than 5.5 robust standard deviations of all such distances
/// and by more than four times (several together: ten times) the largest distance of those four themselves, found
/// without it.  The second condition keeps resonances, which show at their neighbours too; three in a row are never
/// named.  Distances are relative to what is measured, with the floor that the data show. White normal noise makes
/// fewer than one in 10^5 points such.
///
/// None is named below 12 points, among repeats, for magnitude or phase alone, and where they would be more than 15 %
/// of the data: then the noise itself has long tails.
[[nodiscard]] std::vector<std::size_t> isolated_outliers(const FrequencyResponseData& data, Component component);

/// Points that a fit with these options leaves out unless asked to keep them: isolated_outliers(), but none under a
/// robust loss, which limits what they do.
[[nodiscard]] std::vector<std::size_t> left_out_of_fit(const FrequencyResponseData& data, const FitOptions& options);

/// What is told of points that are left out and of those that points_met() takes back, without a stop at the end.
/// @param points  indices of the data, at least one
[[nodiscard]] std::string left_out_sentence(const FrequencyResponseData& data, const std::vector<std::size_t>& points);
[[nodiscard]] std::string taken_back_sentence(const FrequencyResponseData& data,
                                              const std::vector<std::size_t>& points);

/// Those of some points that go with the others after all: a fit to these and the point, from the estimates of `fit`,
/// meets it to within three times the rms that `fit` has, and its own rms is no more than a twentieth larger.  None
/// where `fit` does not follow the others to within their noise, see LackOfFit.  So the flank of a sharp resonance,
/// which two points on either side do not show, is no outlier once a model has the resonance.
/// @param points   indices of the data, increasing
/// @param options  with the constraints of the model
/// @param fit      to without_points(data, points) with these options
[[nodiscard]] std::vector<std::size_t> points_met(const FrequencyResponseData& data,
                                                  const std::vector<std::size_t>& points, const FitOptions& options,
                                                  const FitResult& fit);

/// The data without some points.
/// @param points  indices, increasing
[[nodiscard]] FrequencyResponseData without_points(const FrequencyResponseData& data,
                                                   const std::vector<std::size_t>& points);

}  // namespace frac
