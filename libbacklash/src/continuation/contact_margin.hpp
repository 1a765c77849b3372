// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "orbit_segment.hpp"

namespace backlash::detail {

/// How far the orbit is from losing or gaining a contact: the least of the impact speeds and of the distances of the
/// turning points from the walls, negative where the motion would leave the gap.
struct ContactMargin {
  double margin;
  bool is_speed;        // which of both
  std::size_t index;    // of the impact, or of the one before the turning point
  SegmentImpact touch;  // the contact of speed 0 that the turning point would be
};
[[nodiscard]] ContactMargin contact_margin(const OrbitSegment& orbit);

}  // namespace backlash::detail
