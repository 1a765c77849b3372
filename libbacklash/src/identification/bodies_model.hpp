// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "backlash/identification/bodies_identification.hpp"
#include "identification/residuals/residuals.hpp"
#include "scene_solver.hpp"

namespace backlash::detail {

/// All parameters of two bodies as one formula, which knows their roles and dimensions.
[[nodiscard]] frac::Structure joint_structure(const BodiesStructure& structure);

/// How far it is looked whether bodies follow an orbit.
enum class OrbitCheck {
  existence,  // there is one: enough to compare places
  motion,     // it stays off the walls and is stable
};

/// What each point is compared with, and which of them are used.
/// @param parameters  count of those estimated
[[nodiscard]] std::vector<PointChoice> choose_orbits(const LinearBodies& bodies, const SceneData& data,
                                                     std::size_t parameters, OrbitCheck check, int threads);

/// Residuals of the points that are used, each over the deviation it has with the choice; the Jacobian is from central
/// differences.
class BodiesResiduals final : public frac::detail::Residuals {
 public:
  /// @param structure  stays with the caller, as the data and the map do
  BodiesResiduals(const BodiesStructure& structure, const SceneData& data, const frac::detail::ParameterMap& map,
                  const std::vector<PointChoice>& choices);

  [[nodiscard]] std::size_t points() const noexcept override { return used_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return data_.residuals_per_point(); }
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override;
  [[nodiscard]] double best_factor(std::span<const double>) const override { return 1; }

 private:
  struct Used {
    std::size_t point;
    PointChoice::Kind kind;
    double deviation;
  };
  // False where there are no such bodies.
  bool residuals_at(std::span<const double> theta, double* residual) const;

  const BodiesStructure& structure_;
  const SceneData& data_;
  std::vector<Used> used_;
};

}  // namespace backlash::detail
