// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "backlash/compliant/compliant_bodies.hpp"

namespace fracfit {

/// In whose words a scene is printed: options of this program, a Modelica model, a model of MuJoCo.
enum class SceneWords { options, modelica, mjcf };
[[nodiscard]] std::string_view to_string(SceneWords words);
inline constexpr std::array all_scene_words = {SceneWords::options, SceneWords::modelica, SceneWords::mjcf};

/// Two masses in those words; the page on identifying scenes derives what their parameters mean there.
/// @param contact  where it takes time, in place of the restitution; words of a simulator need one
/// @param command  that made them
[[nodiscard]] std::string scene_in(SceneWords words, const backlash::TwoMassSystem& system,
                                   const std::optional<backlash::CompliantContact>& contact,
                                   const backlash::CoulombFriction& friction, const std::string& command);

}  // namespace fracfit
