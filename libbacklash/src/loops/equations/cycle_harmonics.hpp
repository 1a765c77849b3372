// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>

#include "backlash/loops/limit_cycles.hpp"

namespace backlash::detail {

/// A harmonic of the motion, of order 1 or more.
/// @param strength  its phasor in the force of the impacts on mass 1, N
[[nodiscard]] CycleHarmonic cycle_harmonic(const ControlLoop& loop, double omega, int order,
                                           std::complex<double> strength);

/// h(j omega): -(x2 - x1) under a force of 1 N on mass 1 and its opposite on mass 2, with the controller's answer.
[[nodiscard]] std::complex<double> image_of_gap(const ControlLoop& loop, double omega);

/// Its limit at frequency 0; empty where it grows without bound, as of a body that can drift.
/// @param omega  rad/s, of the motion
[[nodiscard]] std::optional<double> static_gap(const ControlLoop& loop, double omega);
/// Without a controller.
[[nodiscard]] std::optional<double> static_gap(const LinearBodies& bodies, double omega);

}  // namespace backlash::detail
