// SPDX-License-Identifier: BSD-3-Clause
#include "branch_explorer.hpp"

#include <algorithm>
#include <utility>

#include "contact_margin.hpp"
#include "orbit_correction.hpp"
#include "return_map.hpp"

namespace backlash::detail {
namespace {

// Branches kept; a period-doubling cascade of many patterns goes on without end.
constexpr std::size_t most_branches = 2000;
// Branches that are stable over less than this share of the range are followed no further.  There are many of them: the
// pieces on which the orbits of one restitution are stable are about as many in each decade of their lengths.
constexpr double least_stable_share = 1e-4;

// Period in half periods of the whole orbit, impacts, symmetry.
std::array<std::size_t, 3> key(const OrbitSegment& orbit) {
  const std::size_t halves = orbit.symmetric() ? 2 : 1;
  return {halves * static_cast<std::size_t>(orbit.half_periods), halves * orbit.impacts.size(), 2 - halves};
}

bool holds(const std::vector<SegmentBranch>& branches, const OrbitSegment& orbit) {
  return std::any_of(branches.begin(), branches.end(),
                     [&](const SegmentBranch& branch) { return contains(branch, orbit); });
}

// Length of the pieces of the range over which the branch is stable.  Beside a fold or a doubling one side is, be it
// shorter than a step.
double stable_extent(const SegmentBranch& branch) {
  double sum = 0;
  const auto extent = [&](std::size_t i) {
    return std::abs(branch.points[i + 1].orbit.parameter() - branch.points[i].orbit.parameter());
  };
  for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
    if (return_map(branch.points[i].orbit).stable() || return_map(branch.points[i + 1].orbit).stable())
      sum += extent(i);
  }
  for (const SegmentEventAt& event : branch.events) {
    const bool changes = event.kind == SegmentEvent::fold || event.kind == SegmentEvent::flip;
    if (changes && event.after + 1 < branch.points.size()) sum += extent(event.after);
  }
  return sum;
}

}  // namespace

void BranchExplorer::follow(const OrbitSegment& orbit) {
  follow_if_new(orbit);
  follow_queue();
}

void BranchExplorer::follow_if_stable(const OrbitSegment& orbit) {
  if (branches_.size() >= most_branches || !is_wanted(orbit) || is_known(orbit) || holds(unstable_, orbit)) return;
  std::optional<SegmentBranch> branch = branch_through(orbit, range_);
  if (!branch) return;
  if (attracts(*branch)) {
    keep(std::move(*branch));
    follow_queue();
  } else {
    unstable_.push_back(std::move(*branch));
  }
}

void BranchExplorer::follow_queue() {
  while (!queue_.empty() && branches_.size() < most_branches) {
    const Start start = std::move(queue_.front());
    queue_.pop_front();
    std::optional<SegmentBranch> branch = branch_from(start.orbit, start.direction, start.begin, range_);
    if (!branch) continue;
    const OrbitSegment& middle = branch->points[branch->points.size() / 2].orbit;
    if (repeated_round(middle)) {
      follow_if_new(middle);
      continue;
    }
    if (is_known(middle)) continue;
    if (start.begin == SegmentEnd::birth) {
      branch->events.insert(branch->events.begin(), {SegmentEvent::birth, *start.parent, 0});
    } else {
      branch->events.insert(branch->events.begin(), {SegmentEvent::grazing, start.orbit, 0});
    }
    keep(std::move(*branch));
  }
}

std::vector<SegmentBranch> BranchExplorer::take() {
  std::stable_sort(branches_.begin(), branches_.end(), [](const SegmentBranch& a, const SegmentBranch& b) {
    return key(a.points.front().orbit) < key(b.points.front().orbit);
  });
  return std::move(branches_);
}

bool BranchExplorer::is_wanted(const OrbitSegment& orbit) const {
  const auto [half_periods, impacts, asymmetric] = key(orbit);
  return half_periods <= 2 * static_cast<std::size_t>(options_.longest_period) && impacts > 0 &&
         impacts <= static_cast<std::size_t>(options_.most_impacts);
}

bool BranchExplorer::is_known(const OrbitSegment& orbit) const {
  return holds(branches_, orbit);
}

bool BranchExplorer::attracts(const SegmentBranch& branch) const {
  return stable_extent(branch) > least_stable_share * (range_.upper - range_.lower);
}

void BranchExplorer::keep(SegmentBranch branch) {
  // Unstable orbits lead to more of them without end.
  if (!attracts(branch)) {
    branches_.push_back(std::move(branch));
    return;
  }
  for (const SegmentEventAt& event : branch.events) {
    switch (event.kind) {
      case SegmentEvent::fold:
        break;
      case SegmentEvent::flip: {
        const OrbitSegment twice = doubled(event.orbit);
        add({twice, flip_direction(event.orbit), SegmentEnd::birth, event.orbit});
        break;
      }
      case SegmentEvent::birth:
        // The branch of the halves passes there.
        follow_if_new(event.orbit);
        break;
      case SegmentEvent::grazing:
        add_past_grazing(event.orbit);
        break;
    }
  }
  branches_.push_back(std::move(branch));
}

void BranchExplorer::add(Start start) {
  if (is_wanted(start.orbit)) queue_.push_back(std::move(start));
}

void BranchExplorer::follow_if_new(const OrbitSegment& found) {
  const std::optional<OrbitSegment> round = repeated_round(found);
  const OrbitSegment& orbit = round ? *round : found;
  if (!is_wanted(orbit) || is_known(orbit)) return;
  if (std::optional<SegmentBranch> branch = branch_through(orbit, range_)) keep(std::move(*branch));
}

// With a contact of speed 0 more or less the same motion is an orbit of another pattern.
void BranchExplorer::add_past_grazing(const OrbitSegment& orbit) {
  const ContactMargin margin = contact_margin(orbit);
  // A symmetric orbit touches both walls, and may gain an impact at one of them alone.
  if (orbit.symmetric() && !margin.is_speed) add_past_grazing(doubled(orbit));
  if (!margin.is_speed) {
    const OrbitSegment more = with_impact(orbit, margin.index, margin.touch);
    Direction speed(2 * more.impacts.size() + 1, 0.0);
    speed[2 * (margin.index + 1) + 1] = 1;
    if (const auto direction = tangent(more, speed)) add({more, *direction, SegmentEnd::grazing, std::nullopt});
    return;
  }
  if (orbit.impacts.size() < 2) return;
  const OrbitSegment less = without_impact(orbit, margin.index);
  if (const auto direction = tangent(less, parameter_direction(less))) {
    Direction opposite = *direction;
    for (double& value : opposite) value = -value;
    add({less, *direction, SegmentEnd::grazing, std::nullopt});
    add({less, opposite, SegmentEnd::grazing, std::nullopt});
  }
}

}  // namespace backlash::detail
