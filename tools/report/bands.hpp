// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "backlash/describing_function.hpp"
#include "report/sections.hpp"

namespace report {

/// The two smooth stretches of the curve of the base scene, on which the imaginary part is a function of frequency, and
/// what lies between them.
struct Bands {
  std::vector<backlash::DescribingFunctionPoint> chatter;     // sticking in every period, from the lowest frequency on
  std::vector<backlash::DescribingFunctionPoint> between;     // points of the figures, in the order of frequency
  std::vector<backlash::DescribingFunctionPoint> two_impact;  // symmetric two-impact orbit, above the visible jump
  /// From below the lowest frequency of the figures, where the asymptote shows, up to the end of the impacting
  /// motion; a second sweep begins where two impacts per period do.  None without a band.
  std::vector<backlash::DescribingFunctionSweep> whole;
};

/// Densely sampled within the frequencies of the figures.  The asymmetric two-impact orbit below is left out: the curve
/// has a corner where symmetry is lost, which no smooth model can follow.  A band with fewer than ten points comes out
/// empty.
[[nodiscard]] Bands smooth_bands(const Work& work, const Curves& curves);

[[nodiscard]] std::vector<double> omega_of(const std::vector<backlash::DescribingFunctionPoint>& points);
[[nodiscard]] std::vector<double> imaginary_of(const std::vector<backlash::DescribingFunctionPoint>& points);

/// Points as data for a fit of the imaginary part in which each residual is divided by |Im N| itself: sigma = |Im N|.
[[nodiscard]] frac::FrequencyResponseData relative_imaginary_data(
    const std::vector<backlash::DescribingFunctionPoint>& points);

}  // namespace report
