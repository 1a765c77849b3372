// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "orbit_segment.hpp"

namespace backlash::detail {

enum class SegmentEvent {
  fold,     // a multiplier +1: the branch turns back in its parameter
  flip,     // a multiplier -1 of the segment: symmetry breaking of a mirrored one, else period doubling
  grazing,  // a contact of speed 0 is gained or lost
  birth,    // where the halves of a doubled orbit become equal
};

/// Why a branch ends.
enum class SegmentEnd { range, grazing, birth, closed, lost, too_long };

struct SegmentPoint {
  OrbitSegment orbit;
  Direction tangent;  // along the branch
};

struct SegmentEventAt {
  SegmentEvent kind;
  OrbitSegment orbit;  // at a birth that of the halves
  std::size_t after;   // index of the last point before it
};

struct SegmentBranch {
  std::vector<SegmentPoint> points;  // in order along the branch
  std::vector<SegmentEventAt> events;
  SegmentEnd begin;
  SegmentEnd end;
};

struct ParameterRange {
  double lower, upper;
};

/// The branch through an orbit, both ways.  Empty when no regular admissible orbit lies there.
[[nodiscard]] std::optional<SegmentBranch> branch_through(const OrbitSegment& orbit, const ParameterRange& range);
/// The branch that begins at a bifurcation point in the given direction.  Empty when nothing admissible does.
[[nodiscard]] std::optional<SegmentBranch> branch_from(const OrbitSegment& start, const Direction& direction,
                                                       SegmentEnd begin, const ParameterRange& range);
/// True where the orbit, or its mirror image, lies on the branch.
[[nodiscard]] bool contains(const SegmentBranch& branch, const OrbitSegment& orbit);

}  // namespace backlash::detail
