// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// gamma from which on the motion from contact at rest sticks every period, about, from a table; infinite at
/// restitution 1.
[[nodiscard]] double chatter_onset(double restitution);

/// Mean of h between the orbits of two impacts and chatter, from a coarse table; empty elsewhere.
[[nodiscard]] std::optional<std::complex<double>> irregular_h(double gamma, double restitution);

/// What is given of the scene: values where fixed.
using FixedScene = std::array<std::optional<double>, 4>;  // mass1, mass2, clearance, restitution

/// Places from which to search, best first: the best nodes of a grid over mass2 clearance and restitution that are not
/// near each other.
/// @param jumps  values of mass2 clearance for which the scene would jump where the data do, more nodes of the grid
/// @param rate_irregular  as in solve_scene
[[nodiscard]] std::vector<SceneVector> scene_starts(const SceneData& data, const SceneBounds& bounds,
                                                    const FixedScene& fixed, const std::vector<double>& jumps,
                                                    bool rate_irregular, std::size_t count);

}  // namespace backlash::detail
