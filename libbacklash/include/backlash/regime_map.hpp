// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// Two masses of unknown restitution under a force.  The map over omega and restitution is that of any other scene of
/// the same kind stretched by sqrt(F/(M2 clearance)): with all four numbers 1, omega is dimensionless.
struct MapScene {
  double mass1 = 1;            // kg
  double mass2 = 1;            // kg
  double clearance = 1;        // m, >= 0
  double force_amplitude = 1;  // N
};

/// N, regime and error over restitution and frequency.
struct RegimeMap {
  MapScene scene;
  std::vector<double> restitution;
  std::vector<double> omega;  // rad/s
  SweepOptions options;
  std::vector<DescribingFunctionPoint> points;  // restitution slowest

  [[nodiscard]] const DescribingFunctionPoint& at(std::size_t restitution_index, std::size_t omega_index) const {
    return points.at(restitution_index * omega.size() + omega_index);
  }
};

/// Options of a map: as of a sweep, but a mean that is known to 1 % of |N| is good enough.
[[nodiscard]] SweepOptions map_options();

/// The scenes of a map, one per restitution.
/// @throws std::invalid_argument  as regime_map.
[[nodiscard]] std::vector<SweepScene> map_scenes(const MapScene& scene, const std::vector<double>& restitution);

/// One sweep per restitution, computed in parallel; the result does not depend on options.threads.
/// @param restitution  in [0, 1], strictly increasing, not empty
/// @param omega        rad/s, positive, strictly increasing, not empty
/// @param progress     counts points, if given
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed.
[[nodiscard]] RegimeMap regime_map(const MapScene& scene, const std::vector<double>& restitution,
                                   const std::vector<double>& omega, const SweepOptions& options = map_options(),
                                   frac::Progress* progress = nullptr);

}  // namespace backlash
