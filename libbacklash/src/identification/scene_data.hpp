// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "scene_solver.hpp"

namespace backlash::detail {

/// @throws std::invalid_argument  what identify_scene() says of curves, component and weight.
void check_curves(const std::vector<MeasuredDescribingFunction>& curves, const SceneIdentificationOptions& options);

/// Points of x1 with N = 0.
enum class LoadAtRest {
  left_out,  // it tells no more than that the masses do not touch
  kept,      // to speak against bodies that would have an orbit there
};

/// @throws std::invalid_argument  all data zero.
[[nodiscard]] SceneData scene_data(const std::vector<MeasuredDescribingFunction>& curves,
                                   const SceneIdentificationOptions& options,
                                   LoadAtRest at_rest = LoadAtRest::left_out);

/// @throws std::invalid_argument  fewer residuals than parameters.
void require_residuals(const SceneData& data, std::size_t parameters);

/// mass2 clearance = F/(gamma omega_J^2) with the jumps of the data at omega_J.
[[nodiscard]] std::vector<double> products_from_jumps(const std::vector<MeasuredDescribingFunction>& curves);

[[nodiscard]] PointStatus status_of(const PointChoice& choice);

}  // namespace backlash::detail
