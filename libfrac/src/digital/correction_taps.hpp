// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "power_design.hpp"

namespace frac::detail {

/// C(z) = sum taps_k z^-k, which makes up for what the discretising rules leave.
struct CorrectionTaps {
  std::vector<double> taps;
  double error;          // largest |C R - 1| on the band
  double amplification;  // see DigitalPower::most_amplification
};

/// What a correction is for: H = C times sections, differences and integrators of digital_power().
struct CorrectionTask {
  SplitOrder order;
  double sample_time;                // s
  const ParallelSections* sections;  // by the backward difference, s^fractional on the band
  double edge;                       // omega T/2 at the upper edge of the band
};

/// On the band the rules alone leave, x = omega T/2,
///   R(x) = (e^{-jx} sin x/x)^(fractional + differences) (x/tan x)^integrators.
/// A filter that may not look ahead pays for accuracy up to a frequency with gain beyond it.  Of the corrections whose
/// error on the band is at most `tolerance` this is the one of least gain beyond; if that would break a limit, it is
/// the one of least error that does not, or the calmest there is.  Few taps are preferred.
[[nodiscard]] CorrectionTaps correction_taps(const CorrectionTask& task, double tolerance, const DirectLimits& limits);

/// How far the answer of taps and sections to a step, seen through a lag v += lag_share (x - v), rises again after its
/// largest value, over that value.  s^order, 0 < order < 1, only falls: what is above 0 is ringing.
[[nodiscard]] double step_swing(const ParallelSections& sections, const std::vector<double>& taps, double lag_share);

}  // namespace frac::detail
