// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_branch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/bracketed_root.hpp"
#include "contact_margin.hpp"
#include "frac/cancellation.hpp"
#include "orbit_correction.hpp"
#include "return_map.hpp"

namespace backlash::detail {
namespace {

// Length of steps along a branch, in radians of phase and clearances per radian of speed.
constexpr double first_step = 2e-3;
constexpr double longest_step = 0.03;
constexpr double shortest_step = 1e-9;
constexpr std::size_t most_points = 20'000;
// Cosine of the angle between neighbouring tangents below which a step is taken again, shorter.
constexpr double least_cosine = 0.995;
// Change of the parameter within a step beyond both of its ends: a fold bends a branch by its curvature times half the
// square of the step.
constexpr double most_bend = 1e-3;

// One step of a branch: the orbits between two neighbouring points, by distance along the tangent of the first.
class Step {
 public:
  Step(const SegmentPoint& from, double length) : from_(from), length_(length) {}

  [[nodiscard]] std::optional<SegmentPoint> at(double distance) const {
    const std::optional<OrbitSegment> orbit = corrected(moved(from_.orbit, from_.tangent, distance), from_.tangent);
    if (!orbit) return std::nullopt;
    std::optional<Direction> direction = tangent(*orbit, from_.tangent);
    if (!direction) return std::nullopt;
    return SegmentPoint{*orbit, std::move(*direction)};
  }

  // The place where a function of the points vanishes, given that it changes its sign.
  template <typename Function>
  [[nodiscard]] std::optional<std::pair<double, SegmentPoint>> root(const SegmentPoint& to, const Function& f) const {
    const auto along = [&](double distance) -> std::optional<double> {
      const std::optional<SegmentPoint> point = at(distance);
      if (!point) return std::nullopt;
      return f(*point);
    };
    const std::optional<double> distance = bracketed_root(0.0, length_, f(from_), f(to), along);
    if (!distance) return std::nullopt;
    const std::optional<SegmentPoint> point = at(*distance);
    if (!point) return std::nullopt;
    return std::pair{*distance, *point};
  }

 private:
  const SegmentPoint& from_;
  double length_;
};

double flip_of(const SegmentPoint& point) {
  return return_map(point.orbit).flip();
}
double margin_of(const SegmentPoint& point) {
  return contact_margin(point.orbit).margin;
}
double fold_of(const SegmentPoint& point) {
  return point.tangent.back();
}
bool changes(double a, double b) {
  return (a < 0) != (b < 0);
}

// The orbit of a multiplier -1 whose halves a doubled orbit shows between two points.  The halves are a regular orbit
// there, unlike the doubled one, where two branches meet.
std::optional<OrbitSegment> birth_between(const OrbitSegment& from, const OrbitSegment& to) {
  const std::optional<Halves> a = halves(from);
  const std::optional<Halves> b = halves(to);
  const double before = dot(a->difference, a->difference);
  const double share = before / (before - dot(a->difference, b->difference));
  const OrbitSegment guess = moved(a->mean, difference(b->mean, a->mean), share);
  const Direction fixed = parameter_direction(guess);
  const auto at = [&](double parameter) {
    OrbitSegment moved_guess = guess;
    moved_guess.set_parameter(parameter);
    return corrected(moved_guess, fixed);
  };
  const auto flip_at = [&](double parameter) -> std::optional<double> {
    const std::optional<OrbitSegment> orbit = at(parameter);
    if (!orbit) return std::nullopt;
    return return_map(*orbit).flip();
  };
  for (double width = 1e-7; width < 0.1; width *= 4) {
    const double lower = guess.parameter() - width;
    const double upper = guess.parameter() + width;
    const std::optional<double> below = flip_at(lower);
    const std::optional<double> above = flip_at(upper);
    if (!below || !above) return std::nullopt;
    if (!changes(*below, *above)) continue;
    const std::optional<double> root = bracketed_root(lower, upper, *below, *above, flip_at);
    return root ? at(*root) : std::nullopt;
  }
  return std::nullopt;
}

class March {
 public:
  March(SegmentPoint start, const ParameterRange& range) : start_(start), range_(range) {
    branch_.points.push_back(std::move(start));
  }

  // `length` of the first step; the sign of events is not tested in it where the start is a bifurcation point.
  SegmentBranch run(double length, bool from_bifurcation) {
    bool skip_events = from_bifurcation;
    for (;;) {
      frac::throw_if_cancelled();
      if (branch_.points.size() >= most_points) return ended(SegmentEnd::too_long);
      const SegmentPoint from = branch_.points.back();
      const std::optional<SegmentPoint> to = Step(from, length).at(length);
      if (!to || dot(from.tangent, to->tangent) < least_cosine ||
          std::abs(dot(difference(to->orbit, from.orbit), from.tangent) - length) > 0.1 * length ||
          dot(difference(to->orbit, from.orbit), difference(to->orbit, from.orbit)) > 1.1 * length * length) {
        length *= 0.4;
        if (length < shortest_step) return ended(SegmentEnd::lost);
        continue;
      }
      if (advance(from, *to, length, skip_events)) return std::move(branch_);
      skip_events = false;
      const bool smooth = dot(from.tangent, to->tangent) > 0.999;
      length = std::min(longest_step, smooth ? 1.6 * length : length);
    }
  }

 private:
  struct Found {
    double distance;
    SegmentEvent kind;
    SegmentPoint point;
  };

  SegmentBranch ended(SegmentEnd end) {
    branch_.end = end;
    return std::move(branch_);
  }

  // True when the branch ends in this step.
  bool advance(const SegmentPoint& from, const SegmentPoint& to, double length, bool skip_events) {
    const Step step(from, length);
    double last = length;
    std::optional<SegmentEnd> end;
    SegmentPoint last_point = to;
    const auto end_at = [&](const auto& f, SegmentEnd why) {
      const auto root = step.root(to, f);
      if (!root) {
        end = SegmentEnd::lost;
        last = 0;
        last_point = from;
      } else if (root->first < last || !end) {
        last = root->first;
        last_point = root->second;
        end = why;
      }
    };
    for (const double limit : {range_.lower, range_.upper}) {
      const auto beyond = [&](const SegmentPoint& point) { return point.orbit.parameter() - limit; };
      const bool inside = limit == range_.lower ? beyond(to) >= 0 : beyond(to) <= 0;
      if (!inside) {
        if (!changes(beyond(from), beyond(to)) || beyond(from) == 0) {
          branch_.end = SegmentEnd::range;
          return true;
        }
        end_at(beyond, SegmentEnd::range);
      }
    }
    if (margin_of(to) < 0) {
      // A branch that starts at a grazing has margin 0 there.
      if (skip_events || margin_of(from) <= 0) {
        branch_.end = SegmentEnd::grazing;
        return true;
      }
      end_at(margin_of, SegmentEnd::grazing);
    }
    const std::optional<Halves> parts_from = halves(from.orbit);
    const std::optional<Halves> parts_to = halves(to.orbit);
    const bool born = !skip_events && parts_from && parts_to && dot(parts_from->difference, parts_to->difference) < 0;
    if (born && !end) {
      const std::optional<OrbitSegment> birth = birth_between(from.orbit, to.orbit);
      branch_.end = birth ? SegmentEnd::birth : SegmentEnd::lost;
      if (birth) branch_.events.push_back({SegmentEvent::birth, *birth, branch_.points.size() - 1});
      return true;
    }
    if (!skip_events) {
      std::vector<Found> found;
      const auto look = [&](const auto& f, SegmentEvent kind) {
        if (!changes(f(from), f(last_point))) return;
        const auto root = Step(from, last).root(last_point, f);
        if (root) found.push_back({root->first, kind, root->second});
      };
      look(fold_of, SegmentEvent::fold);
      look(flip_of, SegmentEvent::flip);
      std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.distance < b.distance; });
      double before = 0;
      for (Found& event : found) {
        // An orbit that is stable between two events of one step is a point of the branch too, and so is the tip of a
        // fold.
        if (before > 0) {
          if (auto between = step.at(0.5 * (before + event.distance))) branch_.points.push_back(std::move(*between));
        }
        before = event.distance;
        branch_.events.push_back({event.kind, event.point.orbit, branch_.points.size() - 1});
        if (event.kind == SegmentEvent::fold && before < last) branch_.points.push_back(std::move(event.point));
      }
    }
    if (last > 0) branch_.points.push_back(last_point);
    if (end) {
      if (*end == SegmentEnd::grazing)
        branch_.events.push_back({SegmentEvent::grazing, last_point.orbit, branch_.points.size() - 1});
      branch_.end = *end;
      return true;
    }
    return closes(from, to, length);
  }

  // True when an isolated loop has come back to where it began.
  bool closes(const SegmentPoint& from, const SegmentPoint& to, double length) {
    const Direction to_start = difference(start_.orbit, from.orbit);
    const double ahead = dot(to_start, from.tangent);
    const double aside = dot(to_start, to_start) - ahead * ahead;
    left_ = left_ || dot(to_start, to_start) > 4 * longest_step * longest_step;
    if (!left_ || !(ahead >= 0 && ahead <= length && aside < 1e-4 * length * length)) return false;
    if (dot(to.tangent, start_.tangent) < 0.9) return false;
    branch_.end = SegmentEnd::closed;
    return true;
  }

  SegmentPoint start_;
  ParameterRange range_;
  SegmentBranch branch_{{}, {}, SegmentEnd::lost, SegmentEnd::lost};
  bool left_ = false;
};

// The part before the start, met backwards, then the part after it.
SegmentBranch joined(SegmentBranch before, SegmentBranch after) {
  SegmentBranch result;
  result.begin = before.end;
  result.end = after.end;
  const std::size_t shift = before.points.size() - 1;
  for (auto it = before.events.rbegin(); it != before.events.rend(); ++it) {
    const std::size_t index = shift > it->after ? shift - it->after - 1 : 0;
    result.events.push_back({it->kind, std::move(it->orbit), index});
  }
  for (SegmentEventAt& event : after.events)
    result.events.push_back({event.kind, std::move(event.orbit), event.after + shift});
  for (auto it = before.points.rbegin(); it != before.points.rend(); ++it) {
    for (double& value : it->tangent) value = -value;
    result.points.push_back(std::move(*it));
  }
  for (std::size_t i = 1; i < after.points.size(); ++i) result.points.push_back(std::move(after.points[i]));
  return result;
}

// The orbit begun at each of its impacts, and its mirror image the same way.
std::vector<OrbitSegment> representations(const OrbitSegment& orbit) {
  std::vector<OrbitSegment> result;
  for (const OrbitSegment& image : {orbit, mirror_image(orbit)}) {
    for (std::size_t first = 0; first < orbit.impacts.size(); ++first) {
      OrbitSegment begun = image;
      for (std::size_t i = 0; i < orbit.impacts.size(); ++i) begun.impacts[i] = image.impact(first + i);
      result.push_back(std::move(begun));
    }
  }
  return result;
}

// Shifts by whole periods to the phases of another orbit; false where the walls differ.
bool shift_to(OrbitSegment& orbit, const OrbitSegment& other) {
  const double period = 2 * std::numbers::pi;
  const double turns = std::round((other.impacts.front().phase - orbit.impacts.front().phase) / period);
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    if (orbit.impacts[i].wall != other.impacts[i].wall) return false;
    orbit.impacts[i].phase += turns * period;
  }
  return true;
}

}  // namespace

std::optional<SegmentBranch> branch_through(const OrbitSegment& orbit, const ParameterRange& range) {
  if (!(contact_margin(orbit).margin > 0)) return std::nullopt;
  const std::optional<Direction> forward = tangent(orbit, parameter_direction(orbit));
  if (!forward) return std::nullopt;
  Direction backward = *forward;
  for (double& value : backward) value = -value;
  SegmentBranch after = March({orbit, *forward}, range).run(first_step, false);
  if (after.end == SegmentEnd::closed) {
    after.begin = SegmentEnd::closed;
    return after;
  }
  return joined(March({orbit, backward}, range).run(first_step, false), std::move(after));
}

std::optional<SegmentBranch> branch_from(const OrbitSegment& start, const Direction& direction, SegmentEnd begin,
                                         const ParameterRange& range) {
  SegmentBranch branch = March({start, direction}, range).run(first_step, true);
  if (branch.points.size() < 2) return std::nullopt;
  branch.begin = begin;
  return branch;
}

bool contains(const SegmentBranch& branch, const OrbitSegment& orbit) {
  const OrbitSegment& first = branch.points.front().orbit;
  if (first.impacts.size() != orbit.impacts.size() || first.half_periods != orbit.half_periods) return false;
  const std::vector<OrbitSegment> candidates = representations(orbit);
  for (std::size_t i = 0; i + 1 < branch.points.size(); ++i) {
    const OrbitSegment& from = branch.points[i].orbit;
    const double before = from.parameter();
    const double after = branch.points[i + 1].orbit.parameter();
    const double room = 0.2 * std::abs(after - before) + most_bend;
    if (orbit.parameter() < std::min(before, after) - room || orbit.parameter() > std::max(before, after) + room)
      continue;
    Direction chord = difference(branch.points[i + 1].orbit, from);
    const double length = std::sqrt(dot(chord, chord));
    if (!(length > 0)) continue;
    for (double& value : chord) value /= length;
    for (OrbitSegment candidate : candidates) {
      if (!shift_to(candidate, from)) continue;
      const Direction offset = difference(candidate, from);
      const double along = dot(offset, chord);
      const double aside = dot(offset, offset) - along * along;
      // A branch leaves the chord of a step by less than its length.
      if (along < -0.1 * length || along > 1.1 * length || aside > 0.1 * length * length + 1e-12) continue;
      const std::optional<OrbitSegment> there = corrected(moved(from, chord, along), chord);
      if (!there) continue;
      const Direction apart = difference(candidate, *there);
      if (dot(apart, apart) < 1e-14) return true;
    }
  }
  return false;
}

}  // namespace backlash::detail
