// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "compliant_rows.hpp"
#include "compliant_run.hpp"
#include "loops/motions/loop_run.hpp"
#include "loops/motions/sampled_controller.hpp"

namespace backlash {
namespace {

CompliantLoopRow loop_row(const detail::CompliantRun& run, CompliantEvent event) {
  const detail::CompliantFlow& flow = run.flow();
  const double wanted = flow.regime(run.mode()).wanted.row.dot(run.state());
  return {detail::row_of(run, run.time(), event), std::clamp(wanted, -flow.force_limit(), flow.force_limit())};
}

/// Changes of slope of the set-point's line, after t = 0, and the speed that they amount to.
struct Bends {
  std::vector<SetPointKnot> changes;
  double fastest = 0;  // m/s
};
Bends bends_of(const SetPoint& set_point) {
  Bends bends;
  double slope = 0;
  for (std::size_t i = 0; i < set_point.knots.size(); ++i) {
    const SetPointKnot& knot = set_point.knots[i];
    const bool is_last = i + 1 == set_point.knots.size();
    const double next =
        is_last ? 0 : (set_point.knots[i + 1].value - knot.value) / (set_point.knots[i + 1].time - knot.time);
    bends.changes.push_back({knot.time, next - slope});
    slope = next;
    bends.fastest += std::abs(next);
  }
  return bends;
}

// m/s; rounding hides the gap from there on.
double largest_speed(const detail::CompliantFlow& flow, const LoopStart& start, const SetPoint& set_point,
                     const Disturbance& disturbance) {
  constexpr double farthest = 1e9;
  const TwoMassSystem& system = flow.bodies().system();
  const double pushed =
      std::abs(disturbance.body1) / system.mass1() + std::abs(disturbance.body2) / system.mass2();  // m/s^2
  return farthest * (flow.pace() * (system.clearance() + std::abs(set_point.step)) + pushed / flow.pace() +
                     std::abs(start.v1) + std::abs(start.v2) + std::abs(set_point.ramp) + bends_of(set_point).fastest +
                     std::abs(set_point.sine_amplitude) * set_point.sine_omega);
}

// At rest; infinite where that is an integral.
double static_gain(const frac::FractionalTransferFunction& of) {
  const frac::PowerTerm &top = of.numerator().back(), &bottom = of.denominator().back();
  if (top.order > bottom.order) return 0;
  return top.order < bottom.order
             ? std::copysign(std::numeric_limits<double>::infinity(), top.coefficient / bottom.coefficient)
             : top.coefficient / bottom.coefficient;
}

/// a x + b u <= most.
struct HalfPlane {
  double a, b, most;
};

/// Least and largest x + share u + offset of the points that all half planes share, which are bounded; empty where
/// there is none.
std::optional<RestRange> range_of(const std::vector<HalfPlane>& planes, double share, double offset) {
  std::optional<RestRange> range;
  const auto add = [&](double x, double u) {
    for (const HalfPlane& plane : planes) {
      const double size = std::abs(plane.a * x) + std::abs(plane.b * u) + std::abs(plane.most);
      if (!(plane.a * x + plane.b * u <= plane.most + 1e-14 * size)) return;
    }
    const double at = x + share * u + offset;
    if (!range) range = RestRange{at, at};
    range->from = std::min(range->from, at);
    range->to = std::max(range->to, at);
  };
  for (std::size_t i = 0; i < planes.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const HalfPlane &p = planes[i], &q = planes[k];
      const double determinant = p.a * q.b - p.b * q.a;
      if (std::abs(determinant) <= 1e-14 * (std::abs(p.a * q.b) + std::abs(p.b * q.a))) continue;
      add((p.most * q.b - p.b * q.most) / determinant, (p.a * q.most - p.most * q.a) / determinant);
    }
  }
  return range;
}

CompliantLoopHistory ended(CompliantLoopHistory history, LoopEnd end, const detail::CompliantRun& run) {
  history.end = end;
  history.end_time = run.time();
  history.contacts = static_cast<std::size_t>(run.contacts());
  return history;
}

}  // namespace

CompliantLoop::CompliantLoop(CompliantBodies bodies, frac::FractionalTransferFunction controller, Output measured)
    : bodies_(std::move(bodies)), hard_(bodies_.hard(), std::move(controller), measured) {}

CompliantLoopHistory simulate_sampled_loop(const CompliantLoop& loop, const SampledLoopOptions& options) {
  detail::SampledController controller(loop.hard(), options);
  const TwoMassSystem& system = loop.bodies().system();
  const double pace = detail::crossover(loop.hard());
  const double swing = std::max(system.clearance(), std::abs(options.set_point.step));
  const detail::CompliantFlow flow(
      loop.bodies(), {(system.mass1() + system.mass2()) * swing * pace * pace, pace, swing}, options.disturbance);
  const LoopStart start{0, options.velocity1, 0, options.velocity2};
  Eigen::VectorXd state = flow.start(start);
  flow.hold_force(state, 0);
  detail::CompliantRun run(flow, state, flow.mode_of(state));
  run.set_bound(largest_speed(flow, start, options.set_point, options.disturbance));
  CompliantLoopHistory history{{}, 0, LoopEnd::duration, options.duration, flow.error()};
  const auto end_at = [&](LoopEnd end) { return ended(std::move(history), end, run); };
  for (std::size_t n = 0;; ++n) {
    const LoopStart at = detail::CompliantFlow::positions(run.state());
    const double force = controller.step(n, at.x1, at.x2);
    run.hold_force(force);
    history.rows.push_back({detail::row_of(run, run.time(), CompliantEvent::sample), force});
    if (n == controller.samples()) return end_at(LoopEnd::duration);
    for (int events = 0; run.time() < controller.time(n + 1); ++events) {
      run.advance(controller.time(n + 1));
      if (run.has_escaped()) return end_at(LoopEnd::diverged);
      if (run.is_spent() || events > detail::CompliantRun::most_events) return end_at(LoopEnd::most_flights);
    }
  }
}

CompliantLoopHistory simulate_loop(const CompliantLoop& loop, const LoopStart& start, const SetPoint& set_point,
                                   const LoopSimulationOptions& options) {
  using Event = detail::CompliantRun::Event;
  if (options.whole_memory)
    throw std::invalid_argument("contacts that take time are not followed with the whole memory");
  detail::require_simulated(loop.hard(), start, set_point, options);
  const detail::CompliantFlow flow(loop, set_point, options.force_limit, options.tolerance, 0, options.disturbance);
  const Eigen::VectorXd state = flow.start(start);
  detail::CompliantRun run(flow, state, flow.mode_of(state));
  run.set_bound(largest_speed(flow, start, set_point, options.disturbance));
  const Bends bends = bends_of(set_point);
  CompliantLoopHistory history{{}, 0, LoopEnd::duration, options.duration, flow.error()};
  const auto end_at = [&](LoopEnd end) { return ended(std::move(history), end, run); };
  const bool samples = options.sample_time > 0;
  std::size_t sample = 0, bend = 0;
  for (; bend < bends.changes.size() && bends.changes[bend].time <= 0; ++bend)
    run.bend_set_point(bends.changes[bend].value);
  if (samples) history.rows.push_back(loop_row(run, CompliantEvent::sample)), ++sample;
  while (run.time() < options.duration) {
    const double next = samples ? static_cast<double>(sample) * options.sample_time : options.duration;
    double until = std::min(next, options.duration);
    if (bend < bends.changes.size()) until = std::min(until, bends.changes[bend].time);
    const Event event = run.advance(until);
    if (run.has_escaped()) return end_at(LoopEnd::diverged);
    if (run.is_spent()) return end_at(LoopEnd::most_flights);
    if (event != Event::none) {
      if (const auto word = detail::shown(event, run.subject()); word && options.rows_at_impacts)
        history.rows.push_back(loop_row(run, *word));
      if (static_cast<std::size_t>(run.contacts()) >= options.most_impacts) return end_at(LoopEnd::most_impacts);
      continue;
    }
    if (samples && run.time() >= next) {
      history.rows.push_back(loop_row(run, CompliantEvent::sample));
      ++sample;
    }
    for (; bend < bends.changes.size() && bends.changes[bend].time <= run.time(); ++bend)
      run.bend_set_point(bends.changes[bend].value);
  }
  return end_at(LoopEnd::duration);
}

RestRange rest_range(const CompliantLoop& loop, double set_point) {
  constexpr double unbounded = std::numeric_limits<double>::infinity();
  const CompliantBodies& bodies = loop.bodies();
  const double gain = static_gain(loop.controller());
  if (std::isinf(gain)) return {set_point, set_point};
  const double spring1 = 1 / static_gain(bodies.hard().load()), spring2 = 1 / static_gain(bodies.hard().drive());
  const double half = 0.5 * bodies.system().clearance();
  const double friction1 = bodies.friction().body1, friction2 = bodies.friction().body2;
  const bool is_drive = loop.measured() == Output::x2;
  const double on_both = gain + spring2, on_drive = (is_drive ? gain : 0) + spring2;
  std::optional<RestRange> range;
  for (const int wall : {-1, 0, 1}) {
    // u is the contact force on body 1, or x2 - x1 without contact: x2 = x1 + share u + offset.
    const double pressed = wall == 0 ? 0 : 1, share = wall == 0 ? 1 : 1 / bodies.contact().stiffness();
    const double offset = wall * half, given = gain * set_point - on_drive * offset;
    const double drive = -on_drive * share - pressed;
    if (pressed * on_both == spring1 * drive && (wall != 0 || (spring1 == 0 && on_both == 0)))
      return {-unbounded, unbounded};
    std::vector<HalfPlane> planes = {{-spring1, pressed, friction1},
                                     {spring1, -pressed, friction1},
                                     {-on_both, drive, friction2 - given},
                                     {on_both, -drive, friction2 + given}};
    if (wall == 0) {
      planes.push_back({0, 1, half});
      planes.push_back({0, -1, half});
    } else {
      planes.push_back({0, -static_cast<double>(wall), 0});
    }
    const auto found = range_of(planes, is_drive ? share : 0, is_drive ? offset : 0);
    if (!found) continue;
    if (!range) range = found;
    range->from = std::min(range->from, found->from);
    range->to = std::max(range->to, found->to);
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  return range.value_or(RestRange{none, none});
}

}  // namespace backlash
