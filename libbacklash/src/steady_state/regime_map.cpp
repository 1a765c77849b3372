// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/regime_map.hpp"

#include <stdexcept>
#include <string>

#include "base/check.hpp"

namespace backlash {
namespace {

void check(const std::vector<double>& restitution) {
  if (restitution.empty()) throw std::invalid_argument("restitution is empty; it must hold at least one value");
  for (std::size_t i = 0; i < restitution.size(); ++i) {
    if (!(restitution[i] >= 0 && restitution[i] <= 1)) {
      throw std::invalid_argument("restitution[" + std::to_string(i) + "] is " + detail::text(restitution[i]) +
                                  "; it must be in [0, 1]");
    }
    if (i > 0 && !(restitution[i] > restitution[i - 1])) {
      throw std::invalid_argument("restitution[" + std::to_string(i) + "] is " + detail::text(restitution[i]) +
                                  " after restitution[" + std::to_string(i - 1) +
                                  "] = " + detail::text(restitution[i - 1]) + "; it must increase strictly");
    }
  }
}

}  // namespace

SweepOptions map_options() {
  SweepOptions options;
  options.mean_tolerance = 0.01;
  return options;
}

std::vector<SweepScene> map_scenes(const MapScene& scene, const std::vector<double>& restitution) {
  check(restitution);
  std::vector<SweepScene> scenes;
  scenes.reserve(restitution.size());
  for (const double value : restitution)
    scenes.push_back({TwoMassSystem(scene.mass1, scene.mass2, scene.clearance, value), scene.force_amplitude});
  return scenes;
}

RegimeMap regime_map(const MapScene& scene, const std::vector<double>& restitution, const std::vector<double>& omega,
                     const SweepOptions& options, frac::Progress* progress) {
  const std::vector<DescribingFunctionSweep> sweeps =
      describing_function_sweeps(map_scenes(scene, restitution), omega, options, progress);
  RegimeMap map{scene, restitution, omega, options, {}};
  map.points.reserve(restitution.size() * omega.size());
  for (const DescribingFunctionSweep& sweep : sweeps)
    map.points.insert(map.points.end(), sweep.points.begin(), sweep.points.end());
  return map;
}

}  // namespace backlash
