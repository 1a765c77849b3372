// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backlash/identification/bodies_identification.hpp"
#include "backlash/identification/scene_comparison.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// What a scene was identified from.
struct SceneRun {
  std::string command;
  std::vector<std::string> files;  // one per curve
  std::vector<double> forces;      // N, likewise
  std::vector<int> harmonics;      // likewise
  io::Metadata options;
};

[[nodiscard]] std::string scene_json(const SceneRun& run, const backlash::SceneIdentification& result,
                                     const std::optional<backlash::SceneComparison>& comparison);
[[nodiscard]] std::string scene_table(const SceneRun& run, const backlash::SceneIdentification& result,
                                      const std::optional<backlash::SceneComparison>& comparison);

/// Of bodies with friction and springs.
[[nodiscard]] std::string bodies_json(const SceneRun& run, const backlash::BodiesIdentification& result);
[[nodiscard]] std::string bodies_table(const SceneRun& run, const backlash::BodiesIdentification& result);

}  // namespace fracfit
