// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene_model.hpp"

namespace backlash::detail {

/// What is given of the scene: values where fixed.
using FixedScene = std::array<std::optional<double>, 4>;  // mass1, mass2, clearance, restitution

/// Places from which to search, best first: the best nodes of a grid over mass2 clearance and restitution that are not
/// near each other.
/// @param jumps  values of mass2 clearance for which the scene would jump where the data do, more nodes of the grid
/// @param rate_irregular  where the scene is irregular points are compared with its mean there, from a table that takes
///                        some time to make; else they count as not explained at all
[[nodiscard]] std::vector<Coordinates> scene_starts(const SceneData& data, const SceneBounds& bounds,
                                                    const FixedScene& fixed, const std::vector<double>& jumps,
                                                    bool rate_irregular, std::size_t count);

/// Places that the law of -1/N gives without a search, best first and not near each other: the scenes of single points
/// of x1, where both masses or the restitution are known, else of all pairs of points, rated by how well the orbits of
/// two impacts of each explain the others.  Where two points share a motion with two symmetric impacts per period their
/// scene is that of all such points.  Empty for x2 and for one component.
[[nodiscard]] std::vector<Coordinates> law_starts(const SceneData& data, const SceneBounds& bounds,
                                                  const FixedScene& fixed, std::size_t count);

/// Places with dry friction: those that the law gives for points as masses without it would have them, of friction on
/// either mass and on both, and for x2 and for one component the nodes of a grid, of friction on mass 2.
[[nodiscard]] std::vector<Coordinates> rubbing_starts(const SceneData& data, const SceneBounds& bounds,
                                                      const FixedScene& fixed, std::size_t count);

}  // namespace backlash::detail
