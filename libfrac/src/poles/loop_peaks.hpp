// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/stability.hpp"

namespace frac::detail {

/// Largest |S| and |T| of a loop L on a band, S = 1/(1 + L), T = L/(1 + L), limits at omega = 0 and infinity included
/// where the band reaches there.
struct LoopPeaks {
  PeakGain sensitivity;
  PeakGain complementary;
};

/// The extrema are roots of the logarithmic derivatives.  Where dead time turns L by more than some hundred radians the
/// worst phase counts.
/// @param from, to  rad/s; 0 and infinity for all frequencies
[[nodiscard]] LoopPeaks loop_peaks(const FractionalTransferFunction& loop, double from, double to);

}  // namespace frac::detail
