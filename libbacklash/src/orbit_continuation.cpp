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

constexpr std::array<std::pair<OrbitParameter, std::string_view>, 4> parameters = {{
    {OrbitParameter::omega, "omega"},
    {OrbitParameter::force, "force"},
    {OrbitParameter::clearance, "clearance"},
    {OrbitParameter::restitution, "restitution"},
}};
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

// Values of the parameter at which attractors are looked for, each from both walls and from mid-gap.
constexpr std::size_t seed_values = 96;
// Branches kept; a period-doubling cascade of many patterns goes on without end.
constexpr std::size_t most_branches = 200;

// The scene in the units of the gap motion: gamma = F/(M2 clearance omega^2) and restitution.
class Scene {
 public:
  Scene(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter, Output output)
      : system_(system), force_(force_amplitude), omega_(omega), parameter_(parameter), output_(output) {}

  [[nodiscard]] detail::BranchParameter along() const {
    return parameter_ == OrbitParameter::restitution ? detail::BranchParameter::restitution
                                                     : detail::BranchParameter::log_gamma;
  }
  [[nodiscard]] detail::ParameterRange range(double from, double to) const {
    const double a = branch_parameter(from);
    const double b = branch_parameter(to);
    return {std::min(a, b), std::max(a, b)};
  }
  // An orbit with no impacts yet, of the motion at a value of the branch parameter.
  [[nodiscard]] OrbitSegment motion_at(double branch_parameter) const {
    OrbitSegment segment;
    segment.along = along();
    segment.restitution = system_.restitution();
    if (parameter_ == OrbitParameter::restitution) segment.log_gamma = log_gamma(system_, force_, omega_);
    segment.set_parameter(branch_parameter);
    return segment;
  }

  [[nodiscard]] PeriodicOrbit orbit(const OrbitSegment& segment) const {
    const auto [omega, clearance] = scales(segment);
    PeriodicOrbit result{};
    result.parameter = parameter(segment);
    result.omega = omega;
    const double inertia = (system_.mass1() + system_.mass2()) * result.omega * result.omega;
    const std::complex<double> u = detail::harmonic(segment, 1) / segment.gamma();
    result.value = (output_ == Output::x1 ? -(1.0 + u) : -1.0 + system_.mass1() / system_.mass2() * u) / inertia;
    result.multipliers = detail::multipliers(segment);
    result.stable = detail::return_map(segment).stable();
    const std::size_t count = segment.impacts.size() * (segment.symmetric() ? 2 : 1);
    const double unit = clearance * result.omega;
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

  static double log_gamma(const TwoMassSystem& system, double force, double omega) {
    return std::log(force / system.mass2() / system.clearance()) - 2 * std::log(omega);
  }

  [[nodiscard]] double branch_parameter(double value) const {
    switch (parameter_) {
      case OrbitParameter::omega:
        return log_gamma(system_, force_, value);
      case OrbitParameter::force:
        return log_gamma(system_, value, omega_);
      case OrbitParameter::clearance:
        return log_gamma({system_.mass1(), system_.mass2(), value, system_.restitution()}, force_, omega_);
      case OrbitParameter::restitution:
        break;
    }
    return value;
  }

  [[nodiscard]] double parameter(const OrbitSegment& segment) const {
    switch (parameter_) {
      case OrbitParameter::omega:
        return scales(segment).omega;
      case OrbitParameter::force:
        return segment.gamma() * system_.mass2() * system_.clearance() * omega_ * omega_;
      case OrbitParameter::clearance:
        return scales(segment).clearance;
      case OrbitParameter::restitution:
        break;
    }
    // The end of a range is met to rounding, also from outside.
    return std::clamp(segment.restitution, 0.0, 1.0);
  }

  struct Scales {
    double omega, clearance;
  };
  [[nodiscard]] Scales scales(const OrbitSegment& segment) const {
    const double mass = system_.mass2();
    if (parameter_ == OrbitParameter::omega) {
      return {std::sqrt(force_ / mass / system_.clearance()) * std::exp(-0.5 * segment.log_gamma), system_.clearance()};
    }
    if (parameter_ == OrbitParameter::clearance) return {omega_, force_ / mass / (omega_ * omega_) / segment.gamma()};
    return {omega_, system_.clearance()};
  }

  TwoMassSystem system_;
  double force_, omega_;
  OrbitParameter parameter_;
  Output output_;
};

// Collects branches and the starts of those still to be followed.
class Explorer {
 public:
  Explorer(const detail::ParameterRange& range, const OrbitContinuationOptions& options)
      : range_(range), options_(options) {}

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
    if (const auto direction = detail::tangent(less, detail::parameter_direction(less))) {
      detail::Direction opposite = *direction;
      for (double& value : opposite) value = -value;
      add({less, *direction, SegmentEnd::grazing, std::nullopt});
      add({less, opposite, SegmentEnd::grazing, std::nullopt});
    }
  }

  detail::ParameterRange range_;
  OrbitContinuationOptions options_;
  std::vector<SegmentBranch> branches_;
  std::deque<Start> queue_;
};

// The orbit that the motion from a start settles on, where it is a closed one without rests.
std::optional<OrbitSegment> settled(const OrbitSegment& at, const detail::GapState& start) {
  const detail::GapMotion motion(at.gamma(), at.restitution);
  const detail::SteadyState steady = detail::find_steady_state(motion, start, 1e-10);
  if (steady.regime != Regime::periodic && steady.regime != Regime::symmetric) return std::nullopt;
  const auto impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
  std::optional<OrbitSegment> found = detail::orbit_through(motion, steady.end, impacts, 2 * steady.period);
  if (found) found->along = at.along;
  return found;
}

// The half of the symmetric two-impact orbit, in closed form.
std::optional<OrbitSegment> two_impact(OrbitSegment at) {
  const auto orbit = detail::symmetric_two_impact_orbit(at.gamma(), at.restitution);
  if (!orbit) return std::nullopt;
  const double phase = static_cast<double>(orbit->start.half_period) * pi - pi / 2 + orbit->start.s;
  at.half_periods = 1;
  at.impacts = {{phase, orbit->speed, orbit->start.wall}};
  return detail::corrected(at, detail::parameter_direction(at));
}

void require_range(OrbitParameter parameter, double from, double to) {
  const std::string name(to_string(parameter));
  if (parameter == OrbitParameter::restitution) {
    if (!(from >= 0 && from < to && to <= 1)) {
      throw std::invalid_argument(name + " from " + detail::text(from) + " to " + detail::text(to) +
                                  "; must be 0 <= from < to <= 1");
    }
    return;
  }
  const std::string unit = parameter == OrbitParameter::omega   ? "rad/s"
                           : parameter == OrbitParameter::force ? "N"
                                                                : "m";
  detail::require_positive(name + "_from", unit, from);
  detail::require_positive(name + "_to", unit, to);
  if (!(from < to)) {
    throw std::invalid_argument(name + "_from is " + detail::text(from) + "; it must be less than " + name +
                                "_to = " + detail::text(to) + " (" + unit + ")");
  }
}

void check(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter, double from,
           double to, const OrbitContinuationOptions& options) {
  if (parameter != OrbitParameter::force) detail::require_positive("force_amplitude", "N", force_amplitude);
  if (parameter != OrbitParameter::clearance) detail::require_positive("clearance", "m", system.clearance());
  if (parameter != OrbitParameter::omega) detail::require_positive("omega", "rad/s", omega);
  require_range(parameter, from, to);
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

std::string_view to_string(OrbitParameter parameter) {
  return detail::spelling(parameters, parameter);
}
std::string_view to_string(Bifurcation bifurcation) {
  return detail::spelling(bifurcations, bifurcation);
}
std::string_view to_string(BranchEnd end) {
  return detail::spelling(branch_ends, end);
}
OrbitParameter orbit_parameter_from_string(std::string_view text) {
  return detail::from_spelling(parameters, "parameter", text);
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

OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter,
                           double from, double to, const OrbitContinuationOptions& options, frac::Progress* progress) {
  check(system, force_amplitude, omega, parameter, from, to, options);
  const Scene scene(system, force_amplitude, omega, parameter, options.output);
  const detail::ParameterRange range = scene.range(from, to);
  const auto motion_at = [&](std::size_t i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(seed_values);
    return scene.motion_at(range.upper + share * (range.lower - range.upper));
  };
  const std::array<detail::GapState, 3> starts = {detail::state_at_peak(0.5, 0), detail::state_at_peak(0, 0),
                                                  detail::state_at_peak(0.9, -0.6)};
  std::vector<std::optional<OrbitSegment>> seeds(seed_values * starts.size());
  if (progress != nullptr) progress->total += seeds.size();
  frac::parallel_for(seeds.size(), options.threads, [&](std::size_t i) {
    seeds[i] = settled(motion_at(i / starts.size()), starts[i % starts.size()]);
    if (progress != nullptr) ++progress->done;
  });
  Explorer explorer(range, options);
  // The symmetric two-impact orbit attracts nothing at restitution 1 or at low frequency.
  for (std::size_t i = 0; i < seed_values; ++i) {
    if (const auto orbit = two_impact(motion_at(seed_values - 1 - i))) explorer.follow(*orbit);
  }
  for (const auto& seed : seeds) {
    if (seed) explorer.follow(*seed);
  }
  OrbitDiagram diagram{system, force_amplitude, omega, parameter, from, to, options, {}};
  for (const SegmentBranch& branch : explorer.take()) diagram.branches.push_back(scene.branch(branch));
  return diagram;
}

OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega_from, double omega_to,
                           const OrbitContinuationOptions& options, frac::Progress* progress) {
  return orbit_diagram(system, force_amplitude, omega_from, OrbitParameter::omega, omega_from, omega_to, options,
                       progress);
}

}  // namespace backlash
