// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/basins.hpp"
#include "backlash/compliant/compliant_bodies.hpp"

namespace backlash {

/// Where starts of bodies whose contact has a stiffness and a damping lead to, as basins() of two masses: the starts
/// are those of start_about_mean(), so that with dry friction or receptances, where the speed of the centre of mass is
/// a state of its own, the map is a section through the basins.  A mean is one of at most 1280 periods.
/// @return `system` has the restitution of a free contact
/// @throws std::invalid_argument  as basins() and bodies_describing_function().
[[nodiscard]] BasinMap basins(const CompliantBodies& bodies, double force_amplitude, double omega,
                              const std::vector<double>& position, const std::vector<double>& velocity,
                              const SweepOptions& options = {}, frac::Progress* progress = nullptr);
/// The same with a store of the caller's.
[[nodiscard]] BasinMap basins(const CompliantBodies& bodies, double force_amplitude, double omega,
                              const std::vector<double>& position, const std::vector<double>& velocity,
                              const SweepOptions& options, frac::Progress* progress, OutcomeStore& store);

}  // namespace backlash
