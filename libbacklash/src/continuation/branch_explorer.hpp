// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "backlash/orbit_continuation.hpp"
#include "orbit_branch.hpp"

namespace backlash::detail {

/// Collects the branches of orbits that hang together by their bifurcations.
class BranchExplorer {
 public:
  BranchExplorer(const ParameterRange& range, const OrbitContinuationOptions& options)
      : range_(range), options_(options) {}

  /// The branch through an orbit, and whatever branches off.
  void follow(const OrbitSegment& orbit);
  /// Like follow(), but keeps the branch only if a part of it is stable.
  void follow_if_stable(const OrbitSegment& orbit);
  /// All branches: short periods first, then few impacts.
  [[nodiscard]] std::vector<SegmentBranch> take();

 private:
  // Start of a branch that is still to be followed.
  struct Start {
    OrbitSegment orbit;
    Direction direction;
    SegmentEnd begin;
    std::optional<OrbitSegment> parent;
  };

  [[nodiscard]] bool is_wanted(const OrbitSegment& orbit) const;
  [[nodiscard]] bool attracts(const SegmentBranch& branch) const;
  [[nodiscard]] bool is_known(const OrbitSegment& orbit) const;
  void keep(SegmentBranch branch);
  void add(Start start);
  void follow_if_new(const OrbitSegment& found);
  void follow_queue();
  void add_past_grazing(const OrbitSegment& orbit);

  ParameterRange range_;
  OrbitContinuationOptions options_;
  std::vector<SegmentBranch> branches_;
  std::vector<SegmentBranch> unstable_;  // that nothing else is known to lead to
  std::deque<Start> queue_;
};

}  // namespace backlash::detail
