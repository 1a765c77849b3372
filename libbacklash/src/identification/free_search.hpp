// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "free_masses.hpp"
#include "scene_search.hpp"

namespace backlash::detail {

/// Looks for the scene of greatest evidence: from the places that the law of -1/N gives, or the best places of a grid
/// where the data have none, where data without irregular points are explained at once; else also from where the orbits
/// of two impacts alone explain part of the data best, and from more places of a grid that knows the means of irregular
/// motion.
/// @param jumps  values of mass2 clearance, see scene_starts
[[nodiscard]] SceneSearch search_scene(const SceneData& data, const KnownScene& known, const std::vector<double>& jumps,
                                       int threads);

/// Scenes of a family that has more parameters than another one.
struct WiderSearch {
  SceneSearch scenes;
  /// Twice the logarithm of the likelihood of the best scene over that of the best one of the other family; infinite
  /// where there is none, NaN where either has no more residuals than the wider family has parameters, which nearly
  /// anything meets.  Points that neither explains say nothing.
  double evidence;
};

/// Frees the time of a contact: from scenes with hard contacts and, where these do not describe the data, from longer
/// contacts.
/// @param known  with limits of the contact time
/// @param hard  what search_scene() found
[[nodiscard]] WiderSearch search_contact(const SceneData& data, const KnownScene& known, const SceneSearch& hard,
                                         int threads);

/// Frees dry friction: from scenes without, and from where the law of -1/N puts scenes with some on either mass.
/// Scenes with as many parameters as residuals are no scenes here.
/// @param known  with limits of friction
/// @param smooth  the same without friction
/// @param without  what the searches above found; afterwards also the scene beside the best one with friction, which
///                 these may have missed and which alone shows what friction adds to it
[[nodiscard]] WiderSearch search_friction(const SceneData& data, const KnownScene& known, const KnownScene& smooth,
                                          SceneSearch& without, int threads);

}  // namespace backlash::detail
