// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "scene_model.hpp"

namespace backlash::detail {

/// Motions of free masses, in the coordinates of scene_model.hpp: those of hard contacts, or of contacts that take time
/// where `takes_time`, or of masses that rub on the ground, whatever their contacts, where `rubs`.
[[nodiscard]] std::shared_ptr<SceneMotions> free_motions(const SceneData& data, bool takes_time, bool rubs,
                                                         Effort effort, Motions which);

}  // namespace backlash::detail
