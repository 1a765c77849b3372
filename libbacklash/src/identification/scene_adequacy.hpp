// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene_data.hpp"

namespace backlash::detail {

/// Whether a scene describes the data to within their noise.
struct SceneAdequacy {
  /// Of residuals that are neighbours on one curve and one kind of motion; 0 where it may be chance.
  double correlation = 0;
  /// One sentence for each way in which the data contradict the scene.
  std::vector<std::string> misfits;
  /// There are neighbours enough to tell noise from a shape that the scene misses, or nothing but rounding is left.
  bool is_tested = false;
};

/// Three tests, each of which rejects a true scene with white noise about once in a thousand:
///  - neighbouring residuals do not go together so much that the scene misses the shape of the data,
///  - the means of the residuals of the curves do not differ by more than noise makes of them, where noise is told by
///    the differences of neighbours,
///  - no curve has most or all of its points off the motions that the scene has there, nor have all together more than
///    a quarter of them.
[[nodiscard]] SceneAdequacy scene_adequacy(const SceneData& data, const std::vector<PointChoice>& choices,
                                           std::size_t parameters);

/// Whether the data tell the scene from masses that never touch, of which mass 1 stands still and mass 2 has
/// N = -1/(M omega^2): the F test of the parameters that go beyond M, which calls such masses a scene once in a
/// thousand; somewhat more often where only ratios of deviations are known, since points that the scene leaves out,
/// each residual of which counts as met by a parameter of its own, lower the scatter of the others.
/// @param parameters  count of those estimated
/// @param least_variance  of residuals, 0 where only their ratios are known
[[nodiscard]] bool tells_contacts(const SceneData& data, const std::vector<PointChoice>& choices,
                                  std::size_t parameters, double least_variance);

}  // namespace backlash::detail
