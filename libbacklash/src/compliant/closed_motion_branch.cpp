// SPDX-License-Identifier: BSD-3-Clause
#include "closed_motion_branch.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <tuple>
#include <utility>

#include "base/bracketed_root.hpp"
#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"

namespace backlash::detail {
namespace {

using Eigen::VectorXd;
using Index = Eigen::Index;

// Lengths of steps along a branch, in sizes of the states and the logarithm of the parameter; the shortest is next to a
// kink that the branch does not pass ahead.
constexpr double first_step = 2e-3, longest_step = 0.05, shortest_step = 1e-8;
// Of a step that meets a kink: within it the motion is the same one.
constexpr double longest_to_kink = 2e-3;
// A range of a factor 4 takes a hundred motions; each costs milliseconds, unlike one of impacts.
constexpr std::size_t most_motions = 500, most_branches = 500;
// Cosine of the angle between neighbouring tangents below which a step is taken again, shorter.
constexpr double least_cosine = 0.99;

VectorXd along_parameter(Index size) {
  VectorXd direction = VectorXd::Zero(size);
  direction[size - 1] = 1;
  return direction;
}

// The linearised equations of closure at a guess, bordered by a row.
struct Bordered {
  RepeatedMap map;
  Eigen::MatrixXd matrix;
  VectorXd miss;

  [[nodiscard]] VectorXd solved(double miss_share, double border) const {
    VectorXd right(miss.size() + 1);
    right << miss_share * miss, border;
    return frac::detail::solve_square(matrix, right);
  }
};
std::optional<Bordered> bordered(const MapAt& map, const VectorXd& at, const CompliantMode& mode, int steps,
                                 const VectorXd& border) {
  // Of the logarithm of the parameter: what it is off by turns the tangent by as much, and slows Newton's method to
  // that ratio.
  constexpr double difference = 1e-7;
  const Index size = at.size() - 1;
  auto here = map(at.head(size), mode, at[size], steps);
  const auto beside = map(at.head(size), mode, at[size] + difference, steps);
  if (!here || !beside) return std::nullopt;
  Eigen::MatrixXd matrix(size + 1, size + 1);
  matrix.topLeftCorner(size, size) = Eigen::MatrixXd::Identity(size, size) - here->derivative;
  matrix.topRightCorner(size, 1) = (here->visited.back() - beside->visited.back()) / difference;
  matrix.bottomRows(1) = border.transpose();
  VectorXd miss = here->visited.back() - at.head(size);
  if (!matrix.allFinite() || !miss.allFinite()) return std::nullopt;
  return Bordered{std::move(*here), std::move(matrix), std::move(miss)};
}

// In the hyperplane through the guess normal to `normal`; the tangent is on the side of it.
std::optional<ClosedMotion> corrected(const MapAt& map, const VectorXd& guess, const CompliantMode& mode, int steps,
                                      const VectorXd& normal) {
  constexpr int most_iterations = 12;
  // Steps below it are rounding; the step before was its square root.
  constexpr double converged = 1e-10, closed = 1e-8, furthest = 0.5;
  VectorXd at = guess;
  CompliantMode at_mode = mode;
  bool is_last = false;
  for (int i = 0; i <= most_iterations; ++i) {
    std::optional<Bordered> system = bordered(map, at, at_mode, steps, normal);
    if (!system) return std::nullopt;
    if (is_last) {
      if (system->map.mode != at_mode || !(system->miss.cwiseAbs().maxCoeff() < closed)) return std::nullopt;
      VectorXd tangent = system->solved(0, 1);
      const double length = tangent.norm();
      if (!std::isfinite(length) || !(length > 0)) return std::nullopt;
      return ClosedMotion{at, at_mode, steps, tangent / length, std::move(system->map)};
    }
    const VectorXd change = system->solved(1, -normal.dot(at - guess));
    const double largest = change.cwiseAbs().maxCoeff();
    if (!(largest < furthest)) return std::nullopt;
    at += change;
    at_mode = system->map.mode;
    is_last = largest < converged;
  }
  return std::nullopt;
}

double flip_of(const ClosedMotion& motion) {
  std::complex<double> product = 1;
  for (const std::complex<double>& each : motion.multipliers()) product *= 1.0 + each;
  return product.real();
}
double fold_of(const ClosedMotion& motion) {
  return motion.tangent[motion.tangent.size() - 1];
}
bool changes(double a, double b) {
  return (a < 0) != (b < 0);
}
// What is left of the difference of the halves of a motion that may be a doubled one.
VectorXd halves_of(const ClosedMotion& motion) {
  if (motion.steps % 2 != 0) return {};
  return motion.map.visited[static_cast<std::size_t>(motion.steps / 2 - 1)] - motion.state();
}
bool is_stable(const ClosedMotion& motion) {
  return std::abs(motion.multipliers().front()) < 1;
}

ClosedMotionEnd kink_between(const MotionPattern& one, const MotionPattern& other) {
  return one.contacts != other.contacts ? ClosedMotionEnd::contact : ClosedMotionEnd::friction;
}

class March {
 public:
  March(const MapAt& map, ClosedMotion start, const BranchLimits& limits) : map_(map), limits_(limits) {
    branch_.motions.push_back(std::move(start));
  }

  ClosedMotionBranch run() {
    double length = first_step;
    for (;;) {
      frac::throw_if_cancelled();
      if (branch_.motions.size() >= most_motions) return ended(ClosedMotionEnd::too_long);
      const ClosedMotion from = branch_.motions.back();
      std::optional<ClosedMotion> to = at(from, length);
      const bool kinks = to && to->map.pattern != from.map.pattern;
      if (!to || (kinks ? length > longest_to_kink : !is_smooth(from, *to, length))) {
        length *= 0.4;
        if (length >= shortest_step) continue;
        return at_wall(from);
      }
      if (kinks) {
        auto [distance, last] = before_kink(from, *to, length);
        if (advance(from, last, distance)) return std::move(branch_);
        return at_kink(from, *to);
      }
      if (advance(from, *to, length) || closes(from, *to, length)) return std::move(branch_);
      length = std::min(longest_step, 1.6 * length);
    }
  }

 private:
  [[nodiscard]] std::optional<ClosedMotion> at(const ClosedMotion& from, double distance) const {
    return corrected(map_, from.at + distance * from.tangent, from.mode, from.steps, from.tangent);
  }

  static bool is_smooth(const ClosedMotion& from, const ClosedMotion& to, double length) {
    return from.tangent.dot(to.tangent) > least_cosine && (to.at - from.at).norm() < 1.05 * length;
  }

  ClosedMotionBranch ended(ClosedMotionEnd end) {
    branch_.end = end;
    return std::move(branch_);
  }

  ClosedMotionBranch at_kink(const ClosedMotion& from, const ClosedMotion& beyond) {
    branch_.beyond.push_back(beyond);
    return ended(kink_between(from.map.pattern, beyond.map.pattern));
  }

  // The last motion with the pattern of `from`; `to` becomes the first with another.
  std::pair<double, ClosedMotion> before_kink(const ClosedMotion& from, ClosedMotion& to, double length) const {
    double low = 0, high = length;
    ClosedMotion last = from;
    while (high - low > 1e-12) {
      const double middle = 0.5 * (low + high);
      std::optional<ClosedMotion> found = at(from, middle);
      if (!found) break;
      const bool is_before = found->map.pattern == from.map.pattern;
      (is_before ? low : high) = middle;
      (is_before ? last : to) = std::move(*found);
    }
    return {low, std::move(last)};
  }

  // A branch that turns at a kink, or meets another there, has nothing ahead of it: the equations just beyond tell
  // where it leads.
  ClosedMotionBranch at_wall(const ClosedMotion& from) {
    for (double beyond = 1e2 * shortest_step; beyond < 1e-3; beyond *= 10) {
      const auto system = bordered(map_, from.at + beyond * from.tangent, from.mode, from.steps, from.tangent);
      if (!system || system->map.pattern == from.map.pattern) continue;
      branch_.end = kink_between(from.map.pattern, system->map.pattern);
      const VectorXd tangent = system->solved(0, 1).normalized();
      for (const double side : {1.0, -1.0}) {
        auto found = corrected(map_, from.at + side * beyond * tangent, from.mode, from.steps, side * tangent);
        if (!found || found->map.pattern != system->map.pattern) continue;
        branch_.beyond.push_back(std::move(*found));
        return std::move(branch_);
      }
    }
    return std::move(branch_);
  }

  // The place between two motions where a function of them vanishes, given that it changes its sign.
  template <class Function>
  [[nodiscard]] std::optional<std::pair<double, ClosedMotion>> root(const ClosedMotion& from, const ClosedMotion& to,
                                                                    double length, const Function& f) const {
    const auto distance = bracketed_root(0.0, length, f(from), f(to), [&](double s) -> std::optional<double> {
      const auto motion = at(from, s);
      if (!motion) return std::nullopt;
      return f(*motion);
    });
    auto found = distance ? at(from, *distance) : std::nullopt;
    if (!found) return std::nullopt;
    return std::pair{*distance, std::move(*found)};
  }

  // True where the branch ends in this step.
  bool advance(const ClosedMotion& from, ClosedMotion to, double length) {
    bool leaves = false;
    for (const double limit : {limits_.lower, limits_.upper}) {
      const auto beyond = [&](const ClosedMotion& motion) {
        return limit == limits_.lower ? limit - motion.parameter() : motion.parameter() - limit;
      };
      if (!(beyond(to) > 0)) continue;
      leaves = true;
      // A range end is met to rounding.
      auto found = beyond(from) < -1e-12 ? root(from, to, length, beyond) : std::nullopt;
      if (!found) {
        branch_.end = ClosedMotionEnd::range;
        return true;
      }
      length = found->first;
      to = std::move(found->second);
    }
    const VectorXd before = halves_of(from), after = halves_of(to);
    if (before.size() > 0 && before.dot(after) < 0) {
      auto birth = birth_between(from, to);
      branch_.end = birth ? ClosedMotionEnd::birth : ClosedMotionEnd::lost;
      if (birth) branch_.events.push_back({ClosedMotionEvent::birth, std::move(*birth), branch_.motions.size() - 1});
      return true;
    }
    struct Found {
      double distance;
      ClosedMotionEvent kind;
      ClosedMotion motion;
    };
    std::vector<Found> events;
    const auto look = [&](const auto& f, ClosedMotionEvent kind) {
      if (!changes(f(from), f(to))) return;
      if (auto found = root(from, to, length, f)) events.push_back({found->first, kind, std::move(found->second)});
    };
    look(fold_of, ClosedMotionEvent::fold);
    look(flip_of, ClosedMotionEvent::flip);
    std::sort(events.begin(), events.end(), [](const Found& a, const Found& b) { return a.distance < b.distance; });
    double last = 0;
    for (Found& event : events) {
      // A motion that is stable between two events of one step is a point of the branch too.
      if (last > 0)
        if (auto between = at(from, 0.5 * (last + event.distance))) branch_.motions.push_back(std::move(*between));
      last = event.distance;
      branch_.events.push_back({event.kind, event.motion, branch_.motions.size() - 1});
      if (event.kind == ClosedMotionEvent::fold) branch_.motions.push_back(std::move(event.motion));
    }
    if (length > last) branch_.motions.push_back(std::move(to));
    if (leaves) branch_.end = ClosedMotionEnd::range;
    return leaves;
  }

  // The halves where those of a doubled motion become equal: a regular motion there, unlike the doubled one, where two
  // branches meet.
  std::optional<ClosedMotion> birth_between(const ClosedMotion& from, const ClosedMotion& to) const {
    const VectorXd before = halves_of(from), after = halves_of(to);
    const double share = before.squaredNorm() / (before.squaredNorm() - before.dot(after));
    VectorXd guess = from.at + share * (to.at - from.at);
    guess.head(before.size()) += 0.5 * (before + share * (after - before));
    const double parameter = guess[guess.size() - 1];
    const VectorXd fixed = along_parameter(guess.size());
    const auto at = [&](double value) {
      VectorXd moved = guess;
      moved[moved.size() - 1] = value;
      return corrected(map_, moved, from.mode, from.steps / 2, fixed);
    };
    const auto flip_at = [&](double value) -> std::optional<double> {
      const auto motion = at(value);
      if (!motion) return std::nullopt;
      return flip_of(*motion);
    };
    for (double width = 1e-7; width < 0.1; width *= 4) {
      const auto below = flip_at(parameter - width), above = flip_at(parameter + width);
      if (!below || !above) return std::nullopt;
      if (!changes(*below, *above)) continue;
      const auto found = bracketed_root(parameter - width, parameter + width, *below, *above, flip_at);
      return found ? at(*found) : std::nullopt;
    }
    return std::nullopt;
  }

  // True where an isolated loop has come back to where it began.
  bool closes(const ClosedMotion& from, const ClosedMotion& to, double length) {
    const ClosedMotion& start = branch_.motions.front();
    const VectorXd to_start = start.at - from.at;
    const double ahead = to_start.dot(from.tangent);
    has_left_ = has_left_ || to_start.norm() > 2 * longest_step;
    if (!has_left_ || !(ahead >= 0 && ahead <= length) || to.tangent.dot(start.tangent) < 0.9) return false;
    if (to_start.squaredNorm() - ahead * ahead > 1e-4 * length * length) return false;
    branch_.end = ClosedMotionEnd::closed;
    return true;
  }

  const MapAt& map_;
  BranchLimits limits_;
  ClosedMotionBranch branch_{{}, {}, ClosedMotionEnd::lost, ClosedMotionEnd::lost, {}};
  bool has_left_ = false;
};

// The part before the start, met backwards, then the part after it.
ClosedMotionBranch joined(ClosedMotionBranch before, ClosedMotionBranch after) {
  ClosedMotionBranch result{{}, {}, before.end, after.end, std::move(before.beyond)};
  const std::size_t shift = before.motions.size() - 1;
  for (auto it = before.events.rbegin(); it != before.events.rend(); ++it)
    result.events.push_back({it->kind, std::move(it->motion), shift > it->after ? shift - it->after - 1 : 0});
  for (auto& event : after.events) result.events.push_back({event.kind, std::move(event.motion), event.after + shift});
  for (auto it = before.motions.rbegin(); it != before.motions.rend(); ++it) {
    it->tangent *= -1;
    result.motions.push_back(std::move(*it));
  }
  std::move(after.motions.begin() + 1, after.motions.end(), std::back_inserter(result.motions));
  std::move(after.beyond.begin(), after.beyond.end(), std::back_inserter(result.beyond));
  return result;
}

class Explorer {
 public:
  Explorer(const MapAt& map, const BranchLimits& limits) : map_(map), limits_(limits) {}

  void follow(const ClosedMotion& through) {
    queue_.push_back(through);
    while (!queue_.empty() && branches_.size() < most_branches) {
      const ClosedMotion next = std::move(queue_.front());
      queue_.pop_front();
      if (!is_wanted(next) || is_known(next)) continue;
      keep(branch_through(next));
    }
    queue_.clear();
  }

  std::vector<ClosedMotionBranch> take() {
    const auto key = [this](const ClosedMotionBranch& branch) {
      const ClosedMotion& first = branch.motions.front();
      return std::tuple{copies(first) * first.steps, copies(first) * first.map.pattern.contacts, -copies(first)};
    };
    std::stable_sort(branches_.begin(), branches_.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    return std::move(branches_);
  }

 private:
  [[nodiscard]] int copies(const ClosedMotion& motion) const {
    return limits_.mirrors && motion.steps % 2 != 0 ? 2 : 1;
  }

  [[nodiscard]] bool is_wanted(const ClosedMotion& motion) const {
    const std::int64_t contacts = copies(motion) * motion.map.pattern.contacts;
    return copies(motion) * motion.steps <= limits_.most_steps && contacts >= limits_.fewest_contacts &&
           contacts <= limits_.most_contacts && motion.parameter() >= limits_.lower - 1e-12 &&
           motion.parameter() <= limits_.upper + 1e-12;
  }

  [[nodiscard]] ClosedMotionBranch branch_through(const ClosedMotion& motion) const {
    ClosedMotionBranch after = March(map_, motion, limits_).run();
    if (after.end == ClosedMotionEnd::closed) {
      after.begin = ClosedMotionEnd::closed;
      return after;
    }
    ClosedMotion back = motion;
    back.tangent *= -1;
    return joined(March(map_, back, limits_).run(), std::move(after));
  }

  void keep(ClosedMotionBranch branch) {
    const bool attracts = std::any_of(branch.motions.begin(), branch.motions.end(), is_stable) ||
                          std::any_of(branch.events.begin(), branch.events.end(),
                                      [](const auto& event) { return event.kind != ClosedMotionEvent::birth; });
    // Unstable orbits lead to more of them without end.
    if (attracts) {
      for (const auto& event : branch.events) {
        if (event.kind == ClosedMotionEvent::birth) queue_.push_back(event.motion);
        if (event.kind == ClosedMotionEvent::flip)
          if (auto twice = doubled(event.motion)) queue_.push_back(std::move(*twice));
      }
      std::copy(branch.beyond.begin(), branch.beyond.end(), std::back_inserter(queue_));
    }
    branches_.push_back(std::move(branch));
  }

  // A motion of twice as many steps beside one with a multiplier -1.
  [[nodiscard]] std::optional<ClosedMotion> doubled(const ClosedMotion& at) const {
    const frac::detail::Eigensystem system = frac::detail::eigensystem(at.map.derivative);
    Index nearest = 0;
    for (Index i = 1; i < system.values.size(); ++i)
      if (std::abs(1.0 + system.values[i]) < std::abs(1.0 + system.values[nearest])) nearest = i;
    VectorXd direction = VectorXd::Zero(at.at.size());
    direction.head(at.at.size() - 1) = system.vectors.col(nearest).real();
    direction.normalize();
    for (const double distance : {1e-3, 1e-4, 1e-2}) {
      auto found = corrected(map_, at.at + distance * direction, at.mode, 2 * at.steps, direction);
      if (found && halves_of(*found).norm() > distance) return found;
    }
    return std::nullopt;
  }

  [[nodiscard]] bool is_known(const ClosedMotion& motion) const {
    return std::any_of(branches_.begin(), branches_.end(),
                       [&](const ClosedMotionBranch& branch) { return contains(branch, motion); });
  }

  // The motion, or its mirror image, begun after any of its steps, lies on the branch.
  [[nodiscard]] bool contains(const ClosedMotionBranch& branch, const ClosedMotion& motion) const {
    const ClosedMotion& first = branch.motions.front();
    if (first.steps != motion.steps || first.map.pattern != motion.map.pattern) return false;
    // Kinks are located to 1e-12 along a step, and motions to 1e-10 of their sizes.
    constexpr double same = 1e-6;
    VectorXd candidate = motion.at;
    for (const VectorXd& state : motion.map.visited) {
      candidate.head(state.size()) = state;
      for (std::size_t i = 0; i < branch.motions.size(); ++i) {
        const ClosedMotion& from = branch.motions[i];
        if ((candidate - from.at).norm() < same) return true;
        if (i + 1 == branch.motions.size()) break;
        VectorXd chord = branch.motions[i + 1].at - from.at;
        const double length = chord.norm();
        if (!(length > 0)) continue;
        chord /= length;
        const VectorXd offset = candidate - from.at;
        const double along = offset.dot(chord);
        // A branch leaves the chord of a step by less than its length.
        if (along < -0.1 * length || along > 1.1 * length) continue;
        if (offset.squaredNorm() - along * along > 0.1 * length * length + 1e-12) continue;
        const auto there = corrected(map_, from.at + along * chord, from.mode, from.steps, chord);
        if (there && (there->at - candidate).norm() < same) return true;
      }
    }
    return false;
  }

  const MapAt& map_;
  BranchLimits limits_;
  std::vector<ClosedMotionBranch> branches_;
  std::deque<ClosedMotion> queue_;
};

}  // namespace

std::vector<std::complex<double>> ClosedMotion::multipliers() const {
  const Eigen::VectorXcd values = frac::detail::eigenvalues(map.derivative);
  std::vector<std::complex<double>> result(values.begin(), values.end());
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return std::abs(a) > std::abs(b); });
  return result;
}

std::optional<ClosedMotion> closed_motion(const MapAt& map, const VectorXd& state, const CompliantMode& mode,
                                          double value, int steps) {
  constexpr double same = 1e-6;
  VectorXd guess(state.size() + 1);
  guess << state, value;
  const VectorXd fixed = along_parameter(guess.size());
  std::optional<ClosedMotion> found = corrected(map, guess, mode, steps, fixed);
  if (!found) return std::nullopt;
  for (int fewer = 1; fewer < steps; ++fewer) {
    if (steps % fewer != 0) continue;
    const VectorXd& there = found->map.visited[static_cast<std::size_t>(fewer - 1)];
    if ((there - found->state()).norm() < same) return corrected(map, found->at, found->mode, fewer, fixed);
  }
  return found;
}

std::vector<ClosedMotionBranch> closed_motion_branches(const MapAt& map, const std::vector<ClosedMotion>& through,
                                                       const BranchLimits& limits) {
  Explorer explorer(map, limits);
  for (const ClosedMotion& motion : through) explorer.follow(motion);
  return explorer.take();
}

}  // namespace backlash::detail
