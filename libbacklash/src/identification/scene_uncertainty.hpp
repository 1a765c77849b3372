// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// What the Fisher matrix at an estimate says of the parameters.
struct SceneUncertainty {
  std::array<SceneEstimate, 4> parameters;
  std::array<SceneEstimate, 3> combinations;
  std::vector<SceneEstimate> contact;   // see SceneIdentification; empty where the contact time is held at 0
  std::vector<SceneEstimate> friction;  // of both masses; empty where both are held at 0
  std::vector<std::string> free_directions;
  /// One sentence per parameter at a limit beyond which the data pull it by more than their noise does.
  std::vector<std::string> strained;
  std::array<std::array<double, 4>, 4> covariance;
  double condition;
  std::size_t rank;  // directions determined, parameters at a bound among them
};
/// A contact time of 0 that may rise is no limit of the scene, but the hard contact: the other parameters' intervals
/// hold for all contact times that the data allow.  So it is with friction.
/// @param widening  factor on the standard errors
/// @param least_variance  that the residuals count as, over their deviations
/// @param data  tells the unit of the contact time, and which residuals are rounding
[[nodiscard]] SceneUncertainty scene_uncertainty(const NormalEquations& equations, const SceneBounds& bounds,
                                                 const SceneVector& theta, double widening, double least_variance,
                                                 const SceneData& data);

/// Whether the interval is no wider than the value, or the range of restitution: what `identified` asks for.  False
/// without an interval, as at a limit.
[[nodiscard]] bool is_narrow(const SceneEstimate& estimate);

/// Estimates with their 95 % intervals line by line, and the message.
[[nodiscard]] std::string summary_of(std::span<const SceneEstimate> parameters, const std::string& message);

/// Stretches the interval of an estimate over that of another one that explains the data nearly as well.
void stretch_over(const SceneEstimate& rival, SceneEstimate& estimate);

}  // namespace backlash::detail
