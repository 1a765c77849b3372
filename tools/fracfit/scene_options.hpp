// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "backlash/two_mass_system.hpp"
#include "common_options.hpp"

namespace CLI {
class App;
}

namespace fracfit {

/// Two masses and their force, as given; dimensionless by default.
struct SceneOptions {
  std::string force = "1", clearance = "1", mass1 = "1", mass2 = "1";
};

/// --force, --clearance, --m1, --m2.
void add_scene_options(CLI::App& subcommand, SceneOptions& scene);

/// @throws std::invalid_argument  as TwoMassSystem, or an entry that is no number.
[[nodiscard]] backlash::TwoMassSystem system_of(const SceneOptions& scene, const std::string& restitution);

/// The command line up to the scene.
/// @param left_out  force or clearance, where that is what changes
[[nodiscard]] CommandLine scene_command(const std::string& subcommand, const SceneOptions& scene,
                                        const std::string& left_out = {});

}  // namespace fracfit
