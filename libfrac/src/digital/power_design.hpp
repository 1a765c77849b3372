// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "frac/digital/discretise.hpp"

namespace frac::detail {

/// order = fractional + differences - integrators, |fractional| < 1.
struct SplitOrder {
  double fractional;
  int differences;
  int integrators;
};

/// What Discretisation::direct allows beyond the band.
struct DirectLimits {
  double amplification;                                    // see DigitalPower::most_amplification
  double swing = std::numeric_limits<double>::infinity();  // see step_swing(); for 0 < order < 1
  double lag_share = 1;
};

/// digital_power() for a given way to split the order; not grunwald_letnikov.
/// @throws std::invalid_argument  as digital_power().
[[nodiscard]] DigitalPower power_in_sections(const SplitOrder& order, FrequencyBand band, ApproximationGoal goal,
                                             double sample_time, Discretisation method,
                                             ApproximationMethod approximation, const DirectLimits& limits);

}  // namespace frac::detail
