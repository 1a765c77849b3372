// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "scene_family.hpp"

namespace backlash::detail {

/// Of one point: its residuals and their derivatives, a row for each coordinate.  The second ones are 0 when there is
/// only one.
struct PointResiduals {
  std::array<double, 2> value{};
  Eigen::Matrix<double, Eigen::Dynamic, 2> gradient;
};

/// Sums of products over the residuals.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double cost = 0;
  std::size_t residuals = 0;
  std::vector<PointResiduals> points;  // what the sums are made of
};

struct LocalScene {
  Coordinates theta;
  PointChoices choices;
  std::shared_ptr<const SceneMotions> motions;
  double deviance = 0;  // see scene_evidence
  bool converged = false;
  bool usable = false;  // enough residuals for an estimate
};

/// At an estimate, each residual divided by its deviation at that estimate; points whose motion has ended do not enter.
[[nodiscard]] NormalEquations normal_equations(const SceneData& data, const LocalScene& local);

/// Alternates between choosing the steady motion of each point at the estimate and least squares over the points with
/// which the evidence is greatest, until neither changes.
[[nodiscard]] LocalScene solve_scene(const SceneFamily& family, const Coordinates& start, Effort effort,
                                     Motions motions);

}  // namespace backlash::detail
