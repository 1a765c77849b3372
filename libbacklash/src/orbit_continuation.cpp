#include "backlash/orbit_continuation.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "detail/check.hpp"
#include "detail/gap_motion.hpp"
#include "detail/orbit_branch.hpp"
#include "detail/spelling.hpp"
#include "detail/steady_state.hpp"
#include "detail/two_impact_orbit.hpp"

namespace backlash {
namespace {

using detail::OrbitSegment;
using detail::SegmentBranch;
using detail::SegmentEnd;
using detail::SegmentEvent;
using detail::SegmentImpact;

constexpr double pi = std::numbers::pi;

constexpr std::array<std::pair<Bifurcation, std::string_view>, 4> bifurcations = {{
    {Bifurcation::saddle_node, "saddle-node"},
    {Bifurcation::symmetry_breaking, "symmetry-breaking"},
    {Bifurcation::period_doubling, "period-doubling"},
    {Bifurcation::grazing, "grazing"},
}};
constexpr std::array<std::pair<BranchEnd, std::string_view>, 7> branch_ends = {{
    {BranchEnd::range, "range"},
    {BranchEnd::grazing, "grazing"},
    {BranchEnd::symmetry_breaking, "symmetry-breaking"},
    {BranchEnd::period_doubling, "period-doubling"},
    {BranchEnd::closed, "closed"},
    {BranchEnd::lost, "lost"},
    {BranchEnd::too_long, "too-long"},
}};

// Frequencies at which attractors are looked for, each from both walls and from mid-gap.
constexpr std::size_t seed_frequencies = 96;
// Branches kept; a period-doubling cascade of many patterns goes on without end.
constexpr std::size_t most_branches = 200;

class Scene {
 public:
  Scene(const TwoMassSystem& system, double force_amplitude, Output output)
      : system_(system), force_(force_amplitude), output_(output) {}

  [[nodiscard]] double log_gamma(double omega) const { return std::log(dimensionless_force(system_, force_, omega)); }
  [[nodiscard]] double omega(double log_gamma) const {
    return std::sqrt(force_ / system_.mass2() / system_.clearance()) * std::exp(-0.5 * log_gamma);
  }

  [[nodiscard]] PeriodicOrbit orbit(const OrbitSegment& segment) const {
    PeriodicOrbit result{};
    result.omega = omega(segment.log_gamma);
    const double inertia = (system_.mass1() + system_.mass2()) * result.omega * result.omega;
    const std::complex<double> u = detail::harmonic(segment, 1) / segment.gamma();
    result.value = (output_ == Output::x1 ? -(1.0 + u) : -1.0 + system_.mass1() / system_.mass2() * u) / inertia;
    result.multipliers = detail::multipliers(segment);
    result.stable = detail::return_map(segment).stable();
    const std::size_t count = segment.impacts.size() * (segment.symmetric() ? 2 : 1);
    const double unit = system_.clearance() * result.omega;
    const double begin = 2 * pi * std::floor(segment.impacts.front().phase / (2 * pi));
    for (std::size_t i = 0; i < count; ++i) {
      const SegmentImpact impact = segment.impact(i);
      result.impacts.push_back({impact.phase - begin, impact.wall == 0 ? Wall::near : Wall::far, impact.speed * unit});
    }
    return result;
  }

  [[nodiscard]] OrbitBranch branch(const SegmentBranch& segments) const {
    const OrbitSegment& first = segments.points.front().orbit;
    OrbitBranch result{};
    result.symmetric = first.symmetric();
    result.period = result.symmetric ? first.half_periods : first.half_periods / 2;
    result.impacts = static_cast<int>(first.impacts.size()) * (result.symmetric ? 2 : 1);
    for (const auto& point : segments.points) result.orbits.push_back(orbit(point.orbit));
    for (const auto& event : segments.events) {
      result.bifurcations.push_back({kind(event), orbit(event.orbit), event.after});
    }
    result.begin = end(segments, segments.begin);
    result.end = end(segments, segments.end);
    return result;
  }

 private:
  static Bifurcation kind(const detail::SegmentEventAt& event) {
    switch (event.kind) {
      case SegmentEvent::fold:
        return Bifurcation::saddle_node;
      case SegmentEvent::grazing:
        return Bifurcation::grazing;
      case SegmentEvent::flip:
      case SegmentEvent::birth:
        break;
    }
    return event.orbit.symmetric() ? Bifurcation::symmetry_breaking : Bifurcation::period_doubling;
  }

  static BranchEnd end(const SegmentBranch& segments, SegmentEnd end) {
    switch (end) {
      case SegmentEnd::range:
        return BranchEnd::range;
      case SegmentEnd::grazing:
        return BranchEnd::grazing;
      case SegmentEnd::birth:
        return segments.points.front().orbit.half_periods / 2 % 2 != 0 ? BranchEnd::symmetry_breaking
                                                                       : BranchEnd::period_doubling;
      case SegmentEnd::closed:
        return BranchEnd::closed;
      case SegmentEnd::lost:
        return BranchEnd::lost;
      case SegmentEnd::too_long:
        break;
    }
    return BranchEnd::too_long;
  }

  TwoMassSystem system_;
  double force_;
  Output output_;
};

// Collects branches and the starts of those still to be followed.
class Explorer {
 public:
  Explorer(const detail::LogRange& range, const OrbitContinuationOptions& options) : range_(range), options_(options) {}

  void follow(const OrbitSegment& orbit) {
    follow_if_new(orbit);
    while (!queue_.empty() && branches_.size() < most_branches) {
      const Start start = std::move(queue_.front());
      queue_.pop_front();
      std::optional<SegmentBranch> branch = detail::branch_from(start.orbit, start.direction, start.begin, range_);
      if (!branch) continue;
      const OrbitSegment& middle = branch->points[branch->points.size() / 2].orbit;
      if (is_repeated(middle)) {
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

  [[nodiscard]] std::vector<SegmentBranch> take() {
    std::stable_sort(branches_.begin(), branches_.end(), [](const SegmentBranch& a, const SegmentBranch& b) {
      return key(a.points.front().orbit) < key(b.points.front().orbit);
    });
    return std::move(branches_);
  }

 private:
  struct Start {
    OrbitSegment orbit;
    detail::Direction direction;
    SegmentEnd begin;
    std::optional<OrbitSegment> parent;
  };

  // Period in half periods of the whole orbit, impacts, symmetry.
  static std::array<std::size_t, 3> key(const OrbitSegment& orbit) {
    const std::size_t halves = orbit.symmetric() ? 2 : 1;
    return {halves * static_cast<std::size_t>(orbit.half_periods), halves * orbit.impacts.size(), 2 - halves};
  }
  [[nodiscard]] bool is_wanted(const OrbitSegment& orbit) const {
    const auto [half_periods, impacts, asymmetric] = key(orbit);
    return half_periods <= 2 * static_cast<std::size_t>(options_.longest_period) && impacts > 0 &&
           impacts <= static_cast<std::size_t>(options_.most_impacts);
  }
  [[nodiscard]] bool is_known(const OrbitSegment& orbit) const {
    return std::any_of(branches_.begin(), branches_.end(),
                       [&](const SegmentBranch& branch) { return detail::contains(branch, orbit); });
  }

  void keep(SegmentBranch branch) {
    for (const detail::SegmentEventAt& event : branch.events) {
      switch (event.kind) {
        case SegmentEvent::fold:
          break;
        case SegmentEvent::flip: {
          const OrbitSegment twice = detail::doubled(event.orbit);
          add({twice, detail::flip_direction(event.orbit), SegmentEnd::birth, event.orbit});
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

  void add(Start start) {
    if (is_wanted(start.orbit)) queue_.push_back(std::move(start));
  }

  static bool is_repeated(const OrbitSegment& orbit) {
    const std::optional<detail::Halves> parts = detail::halves(orbit);
    return parts && detail::dot(parts->difference, parts->difference) < 1e-12;
  }

  void follow_if_new(const OrbitSegment& found) {
    OrbitSegment orbit = found;
    while (is_repeated(orbit)) orbit = detail::halves(orbit)->mean;
    if (!is_wanted(orbit) || is_known(orbit)) return;
    if (std::optional<SegmentBranch> branch = detail::branch_through(orbit, range_)) keep(std::move(*branch));
  }

  // With a contact of speed 0 more or less the same motion is an orbit of another pattern.
  void add_past_grazing(const OrbitSegment& orbit) {
    const detail::ContactMargin margin = detail::contact_margin(orbit);
    // A symmetric orbit touches both walls, and may gain an impact at one of them alone.
    if (orbit.symmetric() && !margin.is_speed) add_past_grazing(detail::doubled(orbit));
    if (!margin.is_speed) {
      const OrbitSegment more = detail::with_impact(orbit, margin.index, margin.touch);
      detail::Direction speed(2 * more.impacts.size() + 1, 0.0);
      speed[2 * (margin.index + 1) + 1] = 1;
      if (const auto direction = detail::tangent(more, speed))
        add({more, *direction, SegmentEnd::grazing, std::nullopt});
      return;
    }
    if (orbit.impacts.size() < 2) return;
    const OrbitSegment less = detail::without_impact(orbit, margin.index);
    if (const auto direction = detail::tangent(less, detail::gamma_direction(less))) {
      detail::Direction opposite = *direction;
      for (double& value : opposite) value = -value;
      add({less, *direction, SegmentEnd::grazing, std::nullopt});
      add({less, opposite, SegmentEnd::grazing, std::nullopt});
    }
  }

  detail::LogRange range_;
  OrbitContinuationOptions options_;
  std::vector<SegmentBranch> branches_;
  std::deque<Start> queue_;
};

// The orbit that the motion from a start settles on, where it is a closed one without rests.
std::optional<OrbitSegment> settled(double gamma, double restitution, const detail::GapState& start) {
  const detail::GapMotion motion(gamma, restitution);
  const detail::SteadyState steady = detail::find_steady_state(motion, start, 1e-10);
  if (steady.regime != Regime::periodic && steady.regime != Regime::symmetric) return std::nullopt;
  const auto impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
  return detail::orbit_through(motion, steady.end, impacts, 2 * steady.period);
}

// The half of a symmetric two-impact orbit.
OrbitSegment segment_of(const detail::TwoImpactOrbit& orbit, double restitution) {
  const double phase = static_cast<double>(orbit.start.half_period) * pi - pi / 2 + orbit.start.s;
  return {std::log(orbit.gamma), restitution, 1, {{phase, orbit.speed, orbit.start.wall}}};
}

void check(const TwoMassSystem& system, double force_amplitude, double omega_from, double omega_to,
           const OrbitContinuationOptions& options) {
  detail::require_positive("force_amplitude", "N", force_amplitude);
  detail::require_positive("clearance", "m", system.clearance());
  detail::require_positive("omega_from", "rad/s", omega_from);
  detail::require_positive("omega_to", "rad/s", omega_to);
  if (!(omega_from < omega_to)) {
    throw std::invalid_argument("omega_from is " + detail::text(omega_from) +
                                "; it must be less than omega_to = " + detail::text(omega_to) + " (rad/s)");
  }
  for (const auto& [name, value, least] :
       {std::tuple{"longest_period", options.longest_period, 1}, std::tuple{"most_impacts", options.most_impacts, 2},
        std::tuple{"threads", options.threads, 0}}) {
    if (value < least) {
      throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; it must be at least " +
                                  std::to_string(least));
    }
  }
}

}  // namespace

std::string_view to_string(Bifurcation bifurcation) {
  return detail::spelling(bifurcations, bifurcation);
}
std::string_view to_string(BranchEnd end) {
  return detail::spelling(branch_ends, end);
}
Bifurcation bifurcation_from_string(std::string_view text) {
  return detail::from_spelling(bifurcations, "bifurcation", text);
}
BranchEnd branch_end_from_string(std::string_view text) {
  return detail::from_spelling(branch_ends, "branch end", text);
}

PeriodicOrbit mirror_twin(const PeriodicOrbit& orbit, int period) {
  PeriodicOrbit twin = orbit;
  for (OrbitImpact& impact : twin.impacts) {
    impact.phase = std::fmod(impact.phase + pi, 2 * pi * period);
    impact.wall = impact.wall == Wall::near ? Wall::far : Wall::near;
  }
  std::sort(twin.impacts.begin(), twin.impacts.end(),
            [](const OrbitImpact& a, const OrbitImpact& b) { return a.phase < b.phase; });
  return twin;
}

OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega_from, double omega_to,
                           const OrbitContinuationOptions& options, frac::Progress* progress) {
  check(system, force_amplitude, omega_from, omega_to, options);
  const Scene scene(system, force_amplitude, options.output);
  const detail::LogRange range{scene.log_gamma(omega_to), scene.log_gamma(omega_from)};
  const std::array<detail::GapState, 3> starts = {detail::state_at_peak(0.5, 0), detail::state_at_peak(0, 0),
                                                  detail::state_at_peak(0.9, -0.6)};
  std::vector<std::optional<OrbitSegment>> seeds(seed_frequencies * starts.size());
  if (progress != nullptr) progress->total += seeds.size();
  frac::parallel_for(seeds.size(), options.threads, [&](std::size_t i) {
    const double share = (static_cast<double>(i / starts.size()) + 0.5) / static_cast<double>(seed_frequencies);
    const double gamma = std::exp(range.upper + share * (range.lower - range.upper));
    seeds[i] = settled(gamma, system.restitution(), starts[i % starts.size()]);
    if (progress != nullptr) ++progress->done;
  });
  Explorer explorer(range, options);
  // The symmetric two-impact orbit in closed form, which attracts nothing at restitution 1 or at low frequency.
  for (std::size_t i = 0; i < seed_frequencies; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(seed_frequencies);
    const double gamma = std::exp(range.lower + share * (range.upper - range.lower));
    const auto orbit = detail::symmetric_two_impact_orbit(gamma, system.restitution());
    if (!orbit) continue;
    const OrbitSegment segment = segment_of(*orbit, system.restitution());
    if (const auto exact = detail::corrected(segment, detail::gamma_direction(segment))) explorer.follow(*exact);
  }
  for (const auto& seed : seeds) {
    if (seed) explorer.follow(*seed);
  }
  OrbitDiagram diagram{system, force_amplitude, omega_from, omega_to, options, {}};
  for (const SegmentBranch& branch : explorer.take()) diagram.branches.push_back(scene.branch(branch));
  return diagram;
}

}  // namespace backlash
