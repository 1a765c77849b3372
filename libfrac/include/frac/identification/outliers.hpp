// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace frac {

struct RankedFit;

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

/// A frequency response without its isolated_outliers(), of which a model may take some back.
class ScreenedData {
 public:
  /// @param options   of the fit; a robust loss, which limits what outliers do, leaves none out
  /// @param keep_all  none is left out
  ScreenedData(FrequencyResponseData all, const FitOptions& options, bool keep_all);

  [[nodiscard]] const FrequencyResponseData& kept() const { return kept_; }
  /// Indices of all data, increasing.
  [[nodiscard]] const std::vector<std::size_t>& left_out() const { return left_out_; }
  /// What is told of those left out, without a stop at the end; empty where there are none.
  [[nodiscard]] std::string sentence() const;

  /// Takes the points_met() back; where there are such, the fit is to be made anew, as by fit() and identify() of
  /// ScreenedData.
  /// @param options  with the constraints of the model
  /// @param fit      to kept() with these options
  /// @param is_of_component_alone  to the component_alone() of kept()
  /// @return  what is told of them, without a stop at the end; empty where there are none
  std::string take_back_met(const FitOptions& options, const FitResult& fit, bool is_of_component_alone = false);
  /// The same by the model chosen in a ranking made with the options; a given curve meets nothing, as it is no fit.
  std::string take_back_met(FitOptions options, const RankedFit& chosen);
  /// What the last take_back_met() returned.
  [[nodiscard]] const std::string& taken_back() const { return taken_back_; }

  /// Makes indices of what is kept ones of all data.
  void restore_indices(std::vector<std::size_t>& points) const;

 private:
  FrequencyResponseData all_;
  std::vector<std::size_t> left_out_;
  FrequencyResponseData kept_;
  std::string taken_back_;
};

}  // namespace frac
