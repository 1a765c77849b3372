// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_loop.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "frac/cancellation.hpp"
#include "loop_run.hpp"
#include "loops/cycles/frequency_search.hpp"
#include "special/reciprocal_gamma.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<LoopEvent, std::string_view>, 5> event_names{
    {{LoopEvent::sample, "sample"},
     {LoopEvent::before_impact, "before-impact"},
     {LoopEvent::after_impact, "after-impact"},
     {LoopEvent::contact, "contact"},
     {LoopEvent::release, "release"}}};
constexpr std::array<std::pair<LoopEnd, std::string_view>, 5> end_names{{{LoopEnd::duration, "duration"},
                                                                         {LoopEnd::rest, "rest"},
                                                                         {LoopEnd::most_impacts, "most-impacts"},
                                                                         {LoopEnd::most_flights, "most-flights"},
                                                                         {LoopEnd::diverged, "diverged"}}};

// A term of the controller with what it makes of a step (kind 0) and of a change of slope (kind 1) of its input:
// coefficient t^(kind - order + i)/Gamma, i = 0 for the force, 1 and 2 for its integrals.
struct Answer {
  double order;
  std::array<std::array<double, 3>, 2> coefficient;
};

class Loop {
 public:
  Loop(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point)
      : system_(loop.system()), delay_(loop.controller().delay()), state_(start) {
    for (const frac::PowerTerm& term : detail::controller_powers(loop)) {
      Answer answer{term.order, {}};
      for (int kind = 0; kind < 2; ++kind) {
        for (int i = 0; i < 3; ++i) {
          answer.coefficient[static_cast<std::size_t>(kind)][static_cast<std::size_t>(i)] =
              term.coefficient * frac::detail::reciprocal_gamma(kind - term.order + i + 1);
        }
      }
      answers_.push_back(answer);
    }
    // Derivatives have known x1 = start.x1 for ever; the set-point steps.
    changes_.push_back({0, set_point.step - start.x1, set_point.step, set_point.ramp - start.v1});
  }

  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] double gap() const { return state_.x2 - state_.x1; }
  [[nodiscard]] double gap_rate() const { return state_.v2 - state_.v1; }

  // Position and velocity of mass 2, and force, at a time of the present flight, without the start's linear motion.
  struct Driven {
    double position;
    double velocity;
    double force;
  };
  [[nodiscard]] Driven driven(double time) const {
    Driven sum{0, 0, 0};
    visit(time, [&](const Answer& answer, std::size_t kind, double size, double age) {
      const double order = static_cast<double>(kind) - answer.order;
      const double power = age > 0     ? std::pow(age, order)
                           : order < 0 ? std::numeric_limits<double>::infinity()
                                       : order == 0;
      const std::array<double, 3>& c = answer.coefficient[kind];
      if (c[0] != 0) sum.force += size * c[0] * power;
      if (age > 0) {
        sum.velocity += size * c[1] * power * age;
        sum.position += size * c[2] * power * age * age;
      } else if (order == -1) {
        sum.velocity += size * c[1];  // a derivative that meets a step kicks mass 2
      }
    });
    sum.velocity /= system_.mass2();
    sum.position /= system_.mass2();
    return sum;
  }

  [[nodiscard]] LoopRow row(double time, LoopEvent event) const {
    const Driven now = driven(time);
    return {time,
            state_.x1 + state_.v1 * (time - time_),
            state_.v1,
            state_.x2 + (state_.v2 - velocity_offset_) * (time - time_) + now.position - position_offset_,
            state_.v2 - velocity_offset_ + now.velocity,
            now.force,
            event};
  }

  // Moves the start of the present flight.
  void go_to(double time) {
    const LoopRow now = row(time, LoopEvent::sample);
    state_ = {now.x1, now.v1, now.x2, now.v2};
    time_ = time;
    keep_offsets();
  }

  /// At the present time, at a wall. @return speed of the masses towards each other
  double hit() {
    const double rate = gap_rate();
    const ImpactVelocities after = post_impact_velocities(system_, {state_.v1, state_.v2});
    changes_.push_back({time_, 0, 0, state_.v1 - after.mass1});
    state_.v1 = after.mass1;
    state_.v2 = after.mass2;
    keep_offsets();
    return std::abs(rate);
  }

  struct Range {
    double low, high;
  };
  /// Range of the gap's rate from the present time to `to`.  Every power is monotone, and so are its derivatives: young
  /// ones are bounded as they stand, those of old impacts, which nearly cancel, by two terms of Taylor and the range of
  /// the second derivative.
  [[nodiscard]] Range rates_until(double to) const {
    const double width = to - time_;
    Range young{0, 0};
    Range bend{0, 0};
    double rate = state_.v2 - velocity_offset_ - state_.v1;
    double slope = 0;
    visit(to, [&](const Answer& answer, std::size_t kind, double size, double last_age) {
      const double power = static_cast<double>(kind) - answer.order + 1;
      const double c = size * answer.coefficient[kind][1] / system_.mass2();
      if (c == 0) return;
      const double first_age = last_age - width;
      const double last = c * std::pow(last_age, power);
      if (first_age <= 2 * width) {
        const double first = first_age > 0 ? c * std::pow(first_age, power) : power == 0 && first_age == 0 ? c : 0;
        young.low += std::min(first, last);
        young.high += std::max(first, last);
        return;
      }
      const double first = c * std::pow(first_age, power);
      const double scale = power * (power - 1);
      const double first_bend = scale * first / (first_age * first_age);
      const double last_bend = scale * last / (last_age * last_age);
      rate += first;
      slope += power * first / first_age;
      bend.low += std::min(first_bend, last_bend);
      bend.high += std::max(first_bend, last_bend);
    });
    const double square = 0.5 * width * width;
    return {rate + young.low + std::min(0.0, slope * width) + std::min(0.0, bend.low) * square,
            rate + young.high + std::max(0.0, slope * width) + std::max(0.0, bend.high) * square};
  }

 private:
  // Input of the controller from `time` on: a step, as terms of order <= 0 and those above see it, and a slope.
  struct Change {
    double time;
    double step_of_integrals;
    double step_of_derivatives;
    double slope;
  };

  template <typename Visit>
  void visit(double time, const Visit& each) const {
    for (const Change& change : changes_) {
      const double age = time - change.time - delay_;
      if (age < 0) continue;
      for (const Answer& answer : answers_) {
        const double step = answer.order > 0 ? change.step_of_derivatives : change.step_of_integrals;
        if (step != 0) each(answer, 0, step, age);
        if (change.slope != 0) each(answer, 1, change.slope, age);
      }
    }
  }
  void keep_offsets() {
    const Driven now = driven(time_);
    position_offset_ = now.position;
    velocity_offset_ = now.velocity;
  }

  TwoMassSystem system_;
  double delay_;
  std::vector<Answer> answers_;
  std::vector<Change> changes_;
  double time_ = 0;  // at which state_ holds
  LoopStart state_;
  double position_offset_ = 0;  // of driven() at time_
  double velocity_offset_ = 0;
};

// Time of the only crossing of a wall in a flight whose rate has one sign until `to`.
double crossing(const Loop& loop, double wall, double to) {
  const auto beyond = [&](double time) {
    const LoopRow row = loop.row(time, LoopEvent::sample);
    return wall > 0 ? row.x2 - row.x1 - wall : wall - (row.x2 - row.x1);
  };
  double low = loop.time(), high = to;
  double at_low = beyond(low), at_high = beyond(high);
  for (int i = 0; i < 200 && high - low > 4e-16 * high; ++i) {
    // The secant, drawn a little towards the middle so that both ends close in.
    double middle = low + (high - low) * std::clamp(at_low / (at_low - at_high), 0.001, 0.999);
    if (i % 3 == 2) middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    const double at_middle = beyond(middle);
    (at_middle >= 0 ? high : low) = middle;
    (at_middle >= 0 ? at_high : at_low) = at_middle;
  }
  return high;
}

void require_whole_memory(const ControlLoop& loop, const SetPoint& set_point, const LoopSimulationOptions& options) {
  if (!loop.bodies().are_free()) {
    throw std::invalid_argument("a loop is simulated with its whole memory with two free masses");
  }
  if (loop.measured() != Output::x1 || detail::controller_powers(loop).empty()) {
    throw std::invalid_argument(
        "a loop is simulated with its whole memory with the load measured (x1) and a controller that is a sum of "
        "powers "
        "of s with a dead time");
  }
  if (loop.system().restitution() == 0) {
    throw std::invalid_argument(
        "with restitution 0 the masses touch after every impact, which is not followed with the whole memory");
  }
  if (std::isfinite(options.force_limit)) {
    throw std::invalid_argument("a limit of the force is not followed with the whole memory");
  }
  if (set_point.sine_amplitude != 0 || !set_point.knots.empty()) {
    throw std::invalid_argument("with the whole memory the set-point is a step and a ramp");
  }
  if (set_point.lag > 0 || options.disturbance.body1 != 0 || options.disturbance.body2 != 0) {
    throw std::invalid_argument(
        "a lag of the set-point and forces that disturb are not followed with the whole memory");
  }
}

void require_set_point(const ControlLoop& loop, const SetPoint& set_point) {
  for (const double value : {set_point.step, set_point.ramp, set_point.sine_amplitude, set_point.sine_omega}) {
    if (!std::isfinite(value)) throw std::invalid_argument("a number of the start or the set-point is not finite");
  }
  detail::require_not_negative("lag of the set-point", "s", set_point.lag);
  if (set_point.sine_amplitude != 0)
    detail::require_positive("frequency of the set-point", "rad/s", set_point.sine_omega);
  double last = -1;
  for (const SetPointKnot& knot : set_point.knots) {
    if (!std::isfinite(knot.time) || !std::isfinite(knot.value) || !(knot.time > last) ||
        (last < 0 && knot.time != 0)) {
      throw std::invalid_argument("a point of the set-point is at " + detail::text(knot.time) +
                                  " s; times rise strictly from 0");
    }
    last = knot.time;
  }
  const double step = set_point.step + (set_point.knots.empty() ? 0 : set_point.knots.front().value);
  const frac::FractionalTransferFunction& controller = loop.controller();
  const double growth = controller.numerator().front().order - controller.denominator().front().order;
  if (step != 0 && growth > 1 && set_point.lag == 0) {
    throw std::invalid_argument("a step of the set-point meets s^" + detail::text(growth) +
                                ", which throws mass 2 at infinite speed; orders up to 1 are allowed with a step");
  }
}

LoopHistory run_with_whole_memory(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                                  const LoopSimulationOptions& options) {
  Loop motion(loop, start, set_point);
  LoopHistory history{{}, {}, LoopEnd::duration, options.duration, 0};
  const double wall = 0.5 * loop.system().clearance();
  std::size_t sample = 0;
  const auto write_until = [&](double time) {
    if (options.sample_time == 0) return;
    for (; static_cast<double>(sample) * options.sample_time <= time; ++sample) {
      history.rows.push_back(motion.row(static_cast<double>(sample) * options.sample_time, LoopEvent::sample));
    }
  };
  double step = options.duration;
  double last_impact = 0;
  while (motion.time() < options.duration) {
    frac::throw_if_cancelled();
    const double to = std::min(options.duration, motion.time() + step);
    const Loop::Range rate = motion.rates_until(to);
    const double width = to - motion.time();
    const bool is_monotone = rate.low > 0 || rate.high < 0;
    // The wall that it leaves does not count while it leaves.
    const bool stays = motion.gap() + width * std::max(0.0, rate.high) < wall &&
                       motion.gap() + width * std::min(0.0, rate.low) > -wall;
    if (!is_monotone && !stays) {
      step = 0.5 * width;
      // No step is small enough: contact without speed.
      if (step < 1e-12 * (motion.time() + 1e-3)) {
        history.end = LoopEnd::rest;
        history.end_time = motion.time();
        return history;
      }
      continue;
    }
    const LoopRow end = motion.row(to, LoopEvent::sample);
    const double met = rate.low > 0 ? wall : -wall;
    if (stays || std::abs(end.x2 - end.x1) < wall || (met > 0 ? end.x2 - end.x1 < met : end.x2 - end.x1 > met)) {
      write_until(to);
      motion.go_to(to);
      step = 1.6 * width;
      continue;
    }
    const double time = crossing(motion, met, to);
    write_until(time);
    history.rows.push_back(motion.row(time, LoopEvent::before_impact));
    motion.go_to(time);
    const double speed = motion.hit();
    history.rows.push_back(motion.row(time, LoopEvent::after_impact));
    history.impacts.push_back({time, met > 0 ? Wall::far : Wall::near, speed});
    if (time - last_impact < 1e-10 * time && history.impacts.size() > 1) {
      history.end = LoopEnd::rest;
      history.end_time = time;
      return history;
    }
    if (history.impacts.size() == options.most_impacts) {
      history.end = LoopEnd::most_impacts;
      history.end_time = time;
      return history;
    }
    // A first guess of the next step: the way to the other wall.
    step = std::max(0.05 * (time - last_impact), 1e-9 * time);
    last_impact = time;
  }
  return history;
}

}  // namespace

void detail::require_simulated(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                               const LoopSimulationOptions& options) {
  for (const double value : {start.x1, start.v1, start.x2, start.v2}) {
    if (!std::isfinite(value)) throw std::invalid_argument("a number of the start or the set-point is not finite");
  }
  if (!(std::abs(start.x2 - start.x1) <= 0.5 * loop.system().clearance())) {
    throw std::invalid_argument("the start has the masses " + detail::text(start.x2 - start.x1) +
                                " m apart; half the clearance is " + detail::text(0.5 * loop.system().clearance()));
  }
  require_set_point(loop, set_point);
  detail::require_positive("duration", "s", options.duration);
  detail::require_not_negative("sample time", "s", options.sample_time);
  if (options.sample_time > 0 && options.duration / options.sample_time > 1e7) {
    throw std::invalid_argument("duration over sample time makes more than 10^7 rows");
  }
  if (options.most_impacts < 1) throw std::invalid_argument("most_impacts is 0");
  if (!(options.tolerance >= 1e-12 && options.tolerance <= 0.1)) {
    throw std::invalid_argument("tolerance " + detail::text(options.tolerance) + "; allowed is 1e-12 to 0.1");
  }
  if (!(options.force_limit > 0)) throw std::invalid_argument("the limit of the force is not above 0");
  for (const double force : {options.disturbance.body1, options.disturbance.body2})
    if (!std::isfinite(force)) throw std::invalid_argument("a force that disturbs is not finite");
  if (options.disturbance.body1 != 0 && loop.controller().delay() > 0)
    throw std::invalid_argument("a force that disturbs body 1 is not followed with a dead time");
  if (options.whole_memory) require_whole_memory(loop, set_point, options);
}

std::string_view to_string(LoopEvent event) {
  return frac::detail::spelling(event_names, event);
}

std::string_view to_string(LoopEnd end) {
  return frac::detail::spelling(end_names, end);
}

LoopHistory simulate_loop(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                          const LoopSimulationOptions& options) {
  detail::require_simulated(loop, start, set_point, options);
  return options.whole_memory ? run_with_whole_memory(loop, start, set_point, options)
                              : detail::run_loop(loop, start, set_point, options);
}

}  // namespace backlash
