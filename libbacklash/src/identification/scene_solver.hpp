// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <vector>

#include "scene_model.hpp"

namespace backlash::detail {

struct SceneBounds {
  SceneVector lower, upper;  // equal where fixed
  [[nodiscard]] bool is_free(std::size_t k) const { return lower[k] < upper[k]; }
};

/// The steady motion a point is compared with.
struct PointChoice {
  enum class Kind { none, two_impact, sticking, free };
  Kind kind = Kind::none;
  bool used = false;           // near enough to form residuals
  std::complex<double> model;  // at the estimate
  double misfit = 0;           // |model - data| of the fitted parts over its deviation
};

/// Sums of products over the residuals.
struct NormalEquations {
  std::array<std::array<double, 4>, 4> matrix{};
  std::array<double, 4> gradient{};
  double cost = 0;
  std::size_t residuals = 0;
};
/// At an estimate, each residual divided by its deviation at that estimate; points whose motion has ended do not enter.
[[nodiscard]] NormalEquations normal_equations(const SceneData& data, const SceneVector& theta,
                                               const std::vector<PointChoice>& choices);

struct LocalScene {
  SceneVector theta{};
  std::vector<PointChoice> choices;
  double robust_cost = 0;
  bool converged = false;
  bool usable = false;  // at least as many residuals as free parameters
};

enum class Effort {
  glance,  // a few steps, to see whether the place is worth more
  settle,  // until nothing changes
};

/// Alternates between choosing the steady motion of each point at the estimate and least squares over the points near
/// enough to theirs, until neither changes.
/// @param rate_irregular  the robust cost compares points where the scene is irregular with its mean there, from a
/// table
///                        that takes a second to make; else they count as not explained at all
[[nodiscard]] LocalScene solve_scene(const SceneData& data, const SceneBounds& bounds, const SceneVector& start,
                                     Effort effort, bool rate_irregular);

}  // namespace backlash::detail
