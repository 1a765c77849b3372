// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "backlash/identification/scene_identification.hpp"

namespace fracfit {

/// In whose words a scene is printed: options of this program, a Modelica model, a model of MuJoCo.
enum class SceneWords { options, modelica, mjcf };
[[nodiscard]] std::string_view to_string(SceneWords words);
inline constexpr std::array all_scene_words = {SceneWords::options, SceneWords::modelica, SceneWords::mjcf};

/// The scene at the estimate; the page on identifying scenes derives what its parameters mean there.
/// @param command  that made it
/// @throws std::runtime_error  words of a simulator, whose contacts take time, for a contact that does not.
[[nodiscard]] std::string scene_in(SceneWords words, const backlash::SceneIdentification& scene,
                                   const std::string& command);

}  // namespace fracfit
