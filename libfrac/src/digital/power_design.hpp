#pragma once

#include "frac/discretise.hpp"

namespace frac::detail {

/// order = fractional + differences - integrators, |fractional| < 1.
struct SplitOrder {
  double fractional;
  int differences;
  int integrators;
};

/// digital_power() for a given way to split the order; not grunwald_letnikov.
/// @throws std::invalid_argument  as digital_power().
[[nodiscard]] DigitalPower power_in_sections(const SplitOrder& order, FrequencyBand band, ApproximationGoal goal,
                                             double sample_time, Discretisation method,
                                             ApproximationMethod approximation, double most_gain);

}  // namespace frac::detail
