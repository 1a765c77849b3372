// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// What the Fisher matrix at an estimate says of the parameters.
struct SceneUncertainty {
  std::array<SceneEstimate, 4> parameters;
  std::array<SceneEstimate, 3> combinations;
  std::vector<std::string> free_directions;
  std::array<std::array<double, 4>, 4> covariance;
  double condition;
  std::size_t rank;  // directions determined, parameters at a bound among them
};
[[nodiscard]] SceneUncertainty scene_uncertainty(const NormalEquations& equations, const SceneBounds& bounds,
                                                 const SceneVector& theta);

}  // namespace backlash::detail
