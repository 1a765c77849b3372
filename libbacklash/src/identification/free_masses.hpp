// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene_family.hpp"
#include "scene_model.hpp"
#include "scene_start.hpp"

namespace backlash::detail {

constexpr std::array<std::string_view, scene_size> scene_names = {
    "mass1", "mass2", "clearance", "restitution", "contact_time", "friction1", "friction2"};

/// What the caller knows of the scene.
struct KnownScene {
  SceneBounds bounds;
  FixedScene fixed;
  FixedScene start;
};
[[nodiscard]] bool has_friction(const SceneBounds& bounds);

/// @throws std::invalid_argument  what identify_scene() says of constraints.
[[nodiscard]] KnownScene known_scene(const SceneData& data, const SceneIdentificationOptions& options);
/// The same scene without friction, and without friction and contact time.
[[nodiscard]] KnownScene frictionless(KnownScene known);
[[nodiscard]] KnownScene with_hard_contacts(KnownScene known);

/// Two masses on which nothing acts but the force, contacts and, where its bounds allow for it, dry friction.
class FreeMasses final : public SceneFamily {
 public:
  /// Estimates of masses, clearance and restitution, of their combinations, of contacts, which are empty where the
  /// contact time is held at 0, and of friction, likewise.
  struct Estimates {
    std::array<SceneEstimate, 4> parameters;
    std::array<SceneEstimate, 3> combinations;
    std::vector<SceneEstimate> contact, friction;
  };
  [[nodiscard]] static Estimates sorted(const std::vector<SceneEstimate>& estimates);

  FreeMasses(const SceneData& data, const KnownScene& known) : SceneFamily(data, known.bounds), fixed_(known.fixed) {}

  [[nodiscard]] std::shared_ptr<SceneMotions> motions(Effort effort, Motions which) const override;
  [[nodiscard]] std::size_t least_residuals() const override { return free_count(); }
  /// The masses follow from the other coordinates by linear least squares.
  [[nodiscard]] bool agree(const Coordinates& one, const Coordinates& other, double within) const override;
  /// Hard contacts and masses without friction are ideals.
  [[nodiscard]] bool is_ideal(std::size_t k) const override { return k >= 4 && bounds().lower[k] == 0; }
  [[nodiscard]] std::string coordinate_name(std::size_t k) const override;
  [[nodiscard]] std::vector<Quantity> parameters(const Coordinates& theta) const override;
  [[nodiscard]] std::size_t parameter_of(std::size_t k) const override { return k; }
  [[nodiscard]] std::vector<SceneEstimate> estimates(const SceneUncertainty& uncertainty) const override;

 private:
  FixedScene fixed_;
};

}  // namespace backlash::detail
