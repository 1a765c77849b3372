// SPDX-License-Identifier: BSD-3-Clause
#include "compliant_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "frac/cancellation.hpp"

namespace backlash::detail {
CompliantRun::CompliantRun(const CompliantFlow& flow, const Eigen::VectorXd& state, const CompliantMode& mode)
    : flow_(&flow), state_(state), mode_(mode) {}

CompliantRun::Event CompliantRun::advance(double until) {
  using Linear = CompliantFlow::Linear;
  while (time_ < until && !is_spent()) {
    frac::throw_if_cancelled();
    ++flights_;
    const CompliantFlow::Regime& regime = flow_->regime(mode_);
    const FlightPath path(regime.flight, state_);
    double end = std::min(until, time_ + path.horizon());
    double length = end - time_;
    Event met = Event::none;
    int subject = 0;
    // sign times the form plus the offset rises above 0.
    const auto watch = [&](Event event, int of, const Linear& linear, double sign, double offset = 0) {
      if (const auto at = path.signal(linear.form, sign, offset).first_rise(0, length)) {
        length = *at;
        met = event;
        subject = of;
      }
    };
    if (mode_.contact != 0) {
      watch(Event::separation, mode_.contact, flow_->press(regime, mode_.contact), -1);
    } else if (mode_.left != 0) {
      watch(Event::parting, mode_.left, regime.gap, -mode_.left, flow_->half_gap());
      watch(Event::contact, mode_.left, flow_->press(regime, mode_.left), 1);
    } else {
      for (const int wall : {-1, 1}) watch(Event::contact, wall, regime.gap, wall, -flow_->half_gap());
    }
    for (int i = 0; i < 2; ++i) {
      const auto body = static_cast<std::size_t>(i);
      const double limit = flow_->friction(i);
      if (limit == 0) continue;
      const int slide = mode_.slide[body];
      if (slide == 0) {
        watch(Event::slide, i, regime.bodies[body].others, 1, -limit);
        const double before = length;
        watch(Event::slide, i, regime.bodies[body].others, -1, -limit);
        if (length < before) subject = i;
      } else if (mode_.is_starting[body]) {
        watch(Event::turn_of_force, i, regime.bodies[body].acceleration, -slide);
      } else {
        watch(Event::stick, i, regime.bodies[body].velocity, -slide);
      }
    }
    if (std::isfinite(flow_->force_limit())) {
      const double most = flow_->force_limit();
      if (mode_.limit == 0) {
        for (const int sign : {-1, 1}) watch(Event::limit, sign, regime.wanted, sign, -most);
      } else {
        watch(Event::limit, 0, regime.wanted, -mode_.limit, most);
      }
    }
    if (visit_) visit_(regime, mode_, path, length);
    const double place = state_[CompliantFlow::x1], gap = state_[CompliantFlow::gap];
    state_ = path.state(length);
    if (flow_->error() > 0) hold_still(place, gap);
    if (transition_.size() > 0) transition_ = regime.flight.transition(length) * transition_;
    time_ = met == Event::none ? end : time_ + length;
    subject_ = subject;
    const auto body = static_cast<std::size_t>(std::max(0, subject));
    if (met != Event::none && met != Event::limit) flights_ = 0;
    switch (met) {
      case Event::none:
        if (has_escaped()) return Event::none;
        break;
      case Event::contact:
        press(subject);
        return met;
      case Event::separation: {
        mode_.contact = 0;
        // Without damping the force ends where the overlap does.
        if (flow_->bodies().contact().damping() > 0)
          mode_.left = subject;
        else
          state_[CompliantFlow::gap] = subject * flow_->half_gap();
        return met;
      }
      case Event::parting:
        mode_.left = 0;
        state_[CompliantFlow::gap] = subject * flow_->half_gap();
        return met;
      case Event::stick:
        stop(body);
        return mode_.slide[body] == 0 ? Event::stick : Event::reversal;
      case Event::slide: {
        release(body, regime.bodies[body].others.row.dot(state_) > 0 ? 1 : -1);
        return met;
      }
      case Event::turn_of_force:
        mode_.is_starting[body] = false;
        return met;
      case Event::limit:
        // The force is continuous.
        mode_.limit = subject;
        break;
      case Event::reversal:
        break;
    }
  }
  return Event::none;
}

// A wall begins to press, with the force c d' where the bodies have just met.
void CompliantRun::press(int wall) {
  const CompliantFlow::Regime& before = flow_->regime(mode_);
  const bool has_met = mode_.left == 0;
  mode_.contact = wall;
  mode_.left = 0;
  ++contacts_;
  if (!has_met) return;
  state_[CompliantFlow::gap] = wall * flow_->half_gap();
  const CompliantMode pressed = mode_;
  settle_slides();
  if (transition_.size() == 0) return;
  if (mode_ == pressed) {
    // The jump of the field is its change with d' times d', whatever the speed.
    const Eigen::VectorXd change = flow_->regime(mode_).a.col(CompliantFlow::rate) - before.a.col(CompliantFlow::rate);
    transition_ += change * transition_.row(CompliantFlow::gap).eval();
  } else {
    jump(before.gap.row, before);
  }
}

void CompliantRun::settle_slides() {
  const CompliantFlow::Regime& regime = flow_->regime(mode_);
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = flow_->friction(static_cast<int>(i));
    if (limit == 0) continue;
    const double others = regime.bodies[i].others.row.dot(state_);
    if (mode_.slide[i] == 0 && std::abs(others) > limit) release(i, others > 0 ? 1 : -1);
    if (mode_.is_starting[i] && mode_.slide[i] * flow_->regime(mode_).bodies[i].acceleration.row.dot(state_) < 0)
      mode_.is_starting[i] = false;
  }
}

bool CompliantRun::has_escaped() const noexcept {
  if (!state_.allFinite()) return true;
  const double first = state_[CompliantFlow::v1];
  return !(std::max(std::abs(first), std::abs(first + state_[CompliantFlow::rate])) <= bound_);
}

void CompliantRun::bend_set_point(double change_of_slope) {
  flow_->set_point_bends(state_, change_of_slope);
  mode_.limit = flow_->limit_of(state_);
  settle_slides();
}

void CompliantRun::hold_force(double force) {
  flow_->hold_force(state_, force);
  flights_ = 0;
  settle_slides();
}

// Flights of realised powers err by more than rounding, also of bodies that rest.
void CompliantRun::hold_still(double place, double gap) {
  double &x1 = state_[CompliantFlow::x1], &v1 = state_[CompliantFlow::v1];
  if (mode_.slide[0] == 0) {
    state_[CompliantFlow::gap] += x1 - place;
    state_[CompliantFlow::rate] += v1;
    x1 = place;
    v1 = 0;
  }
  if (mode_.slide[1] == 0) {
    state_[CompliantFlow::gap] = gap + (place - x1);
    state_[CompliantFlow::rate] = -v1;
  }
}

void CompliantRun::release(std::size_t body, int sign) {
  mode_.slide[body] = sign;
  mode_.is_starting[body] = true;
}

void CompliantRun::stop(std::size_t body) {
  const CompliantFlow::Regime& before = flow_->regime(mode_);
  const double limit = flow_->friction(static_cast<int>(body));
  if (body == 0) {
    // The other body keeps its velocity.
    state_[CompliantFlow::rate] += state_[CompliantFlow::v1];
    state_[CompliantFlow::v1] = 0;
  } else {
    state_[CompliantFlow::rate] = -state_[CompliantFlow::v1];
  }
  const double others = before.bodies[body].others.row.dot(state_);
  if (std::abs(others) <= limit) {
    mode_.slide[body] = 0;
    ++sticks_;
  } else {
    mode_.slide[body] = others > 0 ? 1 : -1;
  }
  if (transition_.size() > 0) jump(before.bodies[body].velocity.row, before);
}

void CompliantRun::jump(const CompliantFlow::Row& surface, const CompliantFlow::Regime& before) {
  const Eigen::VectorXd field = before.a * state_;
  const Eigen::VectorXd change = flow_->regime(mode_).a * state_ - field;
  const double approach = surface.dot(field);
  if (approach == 0) return;
  transition_ += change / approach * (surface * transition_).eval();
}

bool CompliantRun::follow(int periods) {
  const double period = 2 * std::numbers::pi / flow_->omega();
  const double until = periods * period;
  const std::int64_t allowed = std::int64_t{most_events} * periods;
  for (std::int64_t events = 0; time_ < until; ++events) {
    advance(until);
    if (has_escaped() || events > allowed) return false;
  }
  begin_anew(periods);
  return true;
}

void CompliantRun::begin_transition() {
  transition_ = Eigen::MatrixXd::Identity(state_.size(), state_.size());
  if (mode_.slide[0] == 0) transition_(CompliantFlow::v1, CompliantFlow::v1) = 0;
  if (mode_.slide[1] == 0) transition_.row(CompliantFlow::rate) = -transition_.row(CompliantFlow::v1);
}

void CompliantRun::begin_anew(int periods) {
  time_ = 0;
  phasors_ = flow_->take_phasors(state_, periods);
}

CompliantRun at_next_peak(const CompliantFlow& flow, const LoopStart& at_contact, double angle) {
  constexpr double turn = 2 * std::numbers::pi;
  Eigen::VectorXd state = flow.start(at_contact);
  state[CompliantFlow::cosine] = std::cos(angle);
  state[CompliantFlow::sine] = std::sin(angle);
  CompliantRun run(flow, state, flow.mode_of(state));
  const double until = turn - std::fmod(std::fmod(angle, turn) + turn, turn);
  while (run.time() < until && !run.has_escaped()) run.advance(until);
  const Eigen::VectorXd at_peak = flow.start(CompliantFlow::positions(run.state()));
  return {flow, at_peak, flow.mode_of(at_peak)};
}

}  // namespace backlash::detail
