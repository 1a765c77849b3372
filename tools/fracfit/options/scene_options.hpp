// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "backlash/two_mass_system.hpp"
#include "options/options.hpp"

namespace fracfit {

/// Two masses and their force; dimensionless by default.
struct Scene {
  double force = 1, clearance = 1, mass1 = 1, mass2 = 1;

  /// @throws std::invalid_argument  as TwoMassSystem.
  [[nodiscard]] backlash::TwoMassSystem system(double restitution) const {
    return {mass1, mass2, clearance, restitution};
  }
};

/// --mass1 and --mass2.
void add_masses(Options& options, double& mass1, double& mass2);
/// --force, --clearance, --mass1, --mass2.
void add_scene(Options& options, Scene& scene);

/// Values of which each makes a scene of its own: a list or grid without repetition.
/// @throws std::invalid_argument  also where a list of two looks like one number with a decimal comma.
[[nodiscard]] std::vector<double> scene_values_of(std::string_view name, const std::string& text);

}  // namespace fracfit
