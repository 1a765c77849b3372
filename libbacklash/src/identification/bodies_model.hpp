// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "backlash/identification/bodies_identification.hpp"
#include "identification/residuals/parameter_map.hpp"
#include "scene_family.hpp"

namespace backlash::detail {

/// All parameters of two bodies as one formula, which knows their roles and dimensions.
[[nodiscard]] frac::Structure joint_structure(const BodiesStructure& structure);

/// Parameters at coordinates; rounding does not leave the restitution above 1.
[[nodiscard]] std::vector<double> values_at(const frac::detail::ParameterMap& map, const Coordinates& theta);

/// Two bodies whose receptances are formulas, in the coordinates of the map of the joint formula: those that are free.
/// A point is compared with the symmetric orbit of two impacts, and one of the drive with its motion without impacts.
class Bodies final : public SceneFamily {
 public:
  /// @param structure  stays with the caller, as the data, the joint formula and the map do
  Bodies(const BodiesStructure& structure, const SceneData& data, const frac::Structure& joint,
         const frac::detail::ParameterMap& map);

  [[nodiscard]] std::shared_ptr<SceneMotions> motions(Effort effort, Motions which) const override;
  /// Fewer residuals than twice the parameters can be met by nearly anything.
  [[nodiscard]] std::size_t least_residuals() const override { return 2 * free_count(); }
  [[nodiscard]] bool agree(const Coordinates& one, const Coordinates& other, double within) const override;
  /// Bodies without friction or springs are ideals.
  [[nodiscard]] bool is_ideal(std::size_t k) const override;
  [[nodiscard]] std::string coordinate_name(std::size_t k) const override;
  [[nodiscard]] std::vector<Quantity> parameters(const Coordinates& theta) const override;
  [[nodiscard]] std::size_t parameter_of(std::size_t k) const override { return map_.free()[k].parameter; }
  [[nodiscard]] std::vector<SceneEstimate> estimates(const SceneUncertainty& uncertainty) const override;

 private:
  const BodiesStructure& structure_;
  const frac::Structure& joint_;
  const frac::detail::ParameterMap& map_;
};

}  // namespace backlash::detail
