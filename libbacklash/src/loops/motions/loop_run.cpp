// SPDX-License-Identifier: BSD-3-Clause
#include "loop_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "frac/cancellation.hpp"

namespace backlash::detail {
namespace {

enum : Eigen::Index { x1, v1, x2, v2 };

}  // namespace

LoopRun::LoopRun(const RealisedLoop& loop, const LoopStart& start, const SetPoint& set_point)
    : system_(loop.system()),
      loop_(&loop),
      force_limit_(loop.force_limit()),
      half_clearance_(0.5 * system_.clearance()),
      fastest_(1e9 * loop.pace() * system_.clearance()),
      state_(loop.rest(start)),
      step_(1 / loop.pace()) {
  const double speed = std::max(std::abs(start.v1), std::abs(start.v2));
  if (speed > 0) step_ = std::min(step_, system_.clearance() / speed);
  fastest_ += 1e9 * (speed + std::abs(set_point.ramp) + std::abs(set_point.step) * loop.pace() +
                     std::abs(set_point.sine_amplitude) * set_point.sine_omega);
  fastest_ += 1e9 * loop.push() / loop.pace();
  const double delay = loop.delay();
  using Kind = Planned::Kind;
  if (loop.has_twin()) plan({delay, Kind::twin_starts, start.x1});
  if (loop.has_twin()) plan({delay, Kind::twin_jumps, start.v1});
  plan({delay, Kind::set_point_starts, 0});
  double slope = 0;
  for (std::size_t i = 0; i + 1 < set_point.knots.size(); ++i) {
    const SetPointKnot& knot = set_point.knots[i];
    const SetPointKnot& next = set_point.knots[i + 1];
    const double rate = (next.value - knot.value) / (next.time - knot.time);
    plan({knot.time + delay, Kind::set_point_bends, rate - slope});
    slope = rate;
    fastest_ += 1e9 * std::abs(rate);
  }
  if (!set_point.knots.empty()) plan({set_point.knots.back().time + delay, Kind::set_point_bends, -slope});
  while (!planned_.empty() && planned_.front().time <= 0) {
    apply(planned_.front());
    planned_.pop_front();
  }
  choose_limit();
  before_ = state_;
}

void LoopRun::plan(const Planned& planned) {
  const auto after = std::upper_bound(planned_.begin(), planned_.end(), planned,
                                      [](const Planned& a, const Planned& b) { return a.time < b.time; });
  planned_.insert(after, planned);
}

void LoopRun::apply(const Planned& planned) {
  switch (planned.kind) {
    case Planned::Kind::twin_starts:
      loop_->twin_starts(state_, planned.value);
      break;
    case Planned::Kind::twin_jumps:
      loop_->twin_jumps(state_, planned.value);
      break;
    case Planned::Kind::set_point_starts:
      loop_->set_point_starts(state_);
      break;
    case Planned::Kind::set_point_bends:
      loop_->set_point_bends(state_, planned.value);
      break;
  }
}

LoopRow LoopRun::row_of(const Eigen::VectorXd& state, double time, LoopEvent event) const {
  double force = loop_->regime({RealisedLoop::Limit::none, mode_.contact}).wanted_force_row.dot(state);
  force = std::clamp(force, -force_limit_, force_limit_);
  return {time, state[x1], state[v1], state[x2], state[v2], force, event};
}

bool LoopRun::has_diverged() const {
  return is_lost_ || !(std::max(std::abs(state_[v1]), std::abs(state_[v2])) < fastest_);
}

// What would part the masses is what presses them together.
double LoopRun::contact_force() const {
  const double mass1 = system_.mass1(), mass2 = system_.mass2();
  return mass1 * mass2 / (mass1 + mass2) * loop_->regime(mode_).gap_acceleration.dot(state_);
}

// Chooses the limit that the force asked for now is held at, if any.
void LoopRun::choose_limit() {
  if (!std::isfinite(force_limit_)) return;
  const double wanted = loop_->regime({RealisedLoop::Limit::none, mode_.contact}).wanted_force_row.dot(state_);
  mode_.limit = wanted > force_limit_    ? RealisedLoop::Limit::high
                : wanted < -force_limit_ ? RealisedLoop::Limit::low
                                         : RealisedLoop::Limit::none;
}

LoopRun::Event LoopRun::advance(double until) {
  using Limit = RealisedLoop::Limit;
  while (time_ < until && !is_spent()) {
    frac::throw_if_cancelled();
    ++flights_;
    const RealisedLoop::Regime& regime = loop_->regime(mode_);
    const FlightPath path(regime.flight, state_);
    double end = std::min(until, time_ + std::min(step_, path.horizon()));
    if (!planned_.empty()) end = std::min(end, planned_.front().time);
    double length = end - time_;
    enum class Guard { none, far, near, high, low, back, release } met = Guard::none;
    const auto watch = [&](Guard guard, const LinearFlight::Form& form, double sign, double offset, double from = 0) {
      if (from >= length) return;
      const FlightPath::Signal signal = path.signal(form, sign, offset);
      is_lost_ = is_lost_ || !signal.is_finite();
      if (const auto at = signal.first_rise(from, length)) {
        length = *at;
        met = guard;
      }
    };
    if (mode_.contact) {
      watch(Guard::release, regime.contact_force, -wall_, 0);
    } else {
      const double wait = std::max(0.0, free_until_ - time_);
      watch(Guard::far, regime.gap, 1, -half_clearance_, left_wall_ > 0 ? wait : 0);
      watch(Guard::near, regime.gap, -1, -half_clearance_, left_wall_ < 0 ? wait : 0);
    }
    if (std::isfinite(force_limit_)) {
      if (mode_.limit == Limit::none) {
        watch(Guard::high, regime.wanted_force, 1, -force_limit_);
        watch(Guard::low, regime.wanted_force, -1, -force_limit_);
      } else {
        const double sign = mode_.limit == Limit::high ? -1 : 1;
        watch(Guard::back, regime.wanted_force, sign, force_limit_);
      }
    }
    state_ = path.state(length);
    time_ = met == Guard::none ? end : time_ + length;
    switch (met) {
      case Guard::none:
        step_ *= 2;
        if (has_diverged()) return Event::none;
        while (!planned_.empty() && planned_.front().time <= time_) {
          apply(planned_.front());
          planned_.pop_front();
          choose_limit();
        }
        break;
      case Guard::far:
        return strike(1);
      case Guard::near:
        return strike(-1);
      case Guard::high:
        mode_.limit = Limit::high;
        break;
      case Guard::low:
        mode_.limit = Limit::low;
        break;
      case Guard::back:
        mode_.limit = Limit::none;
        break;
      case Guard::release:
        before_ = state_;
        mode_.contact = false;
        left_wall_ = wall_;
        // It leaves as the cube of time, which rounding would hide at first.
        free_until_ = time_ + 1e-4 / loop_->pace();
        step_ = 0.1 / loop_->pace();
        return Event::release;
    }
  }
  return Event::none;
}

LoopRun::Event LoopRun::strike(double wall) {
  before_ = state_;
  flights_ = 0;
  const double rate = state_[v2] - state_[v1];
  const ImpactVelocities after = post_impact_velocities(system_, {state_[v1], state_[v2]});
  const double change = after.mass1 - state_[v1];
  loop_->jump(state_, change, after.mass2 - state_[v2]);
  if (loop_->has_twin()) plan({time_ + loop_->delay(), Planned::Kind::twin_jumps, change});
  state_[x2] = state_[x1] + wall * half_clearance_;
  const double flight = time_ - last_event_;
  crowded_ = flight < 1e-9 / loop_->pace() ? crowded_ + 1 : 0;
  if (crowded_ > 400) is_stuck_ = true;
  last_event_ = time_;
  step_ = std::max(1.25 * flight, 1e-3 / loop_->pace());
  left_wall_ = wall;
  free_until_ = time_;
  choose_limit();
  double slowest = 1e-10 * std::max({loop_->pace() * system_.clearance(), std::abs(state_[v1]), std::abs(state_[v2])});
  const double acceleration = std::abs(loop_->regime(mode_).gap_acceleration.dot(state_));
  const double rounding = 16 * std::numeric_limits<double>::epsilon() *
                          std::max({half_clearance_, std::abs(state_[x1]), std::abs(state_[x2])});
  // Bounces that leave the wall by no more than the rounding of positions may never become slower.
  if (std::abs(rate) > 0.98 * last_impact_.speed && rate * rate < 2 * rounding * acceleration) slowest = std::abs(rate);
  if (std::abs(state_[v2] - state_[v1]) < slowest) {
    const Event event = touch(wall);
    if (event == Event::contact && std::abs(rate) < slowest) return event;
  }
  last_impact_ = {time_, wall > 0 ? Wall::far : Wall::near, std::abs(rate)};
  return Event::impact;
}

// At a wall without speed.
LoopRun::Event LoopRun::touch(double wall) {
  const double mass = system_.mass1() + system_.mass2();
  const double together = (system_.mass1() * state_[v1] + system_.mass2() * state_[v2]) / mass;
  const double change = together - state_[v1];
  loop_->jump(state_, change, together - state_[v2]);
  if (loop_->has_twin() && change != 0) plan({time_ + loop_->delay(), Planned::Kind::twin_jumps, change});
  if (wall * loop_->regime(mode_).gap_acceleration.dot(state_) > 0) {
    // The twin of the load knows impacts only, and not what presses in between.
    if (loop_->has_twin()) is_stuck_ = true;
    mode_.contact = true;
    wall_ = wall;
    step_ = 1 / loop_->pace();
    choose_limit();
    return Event::contact;
  }
  // It leaves as the square of time.
  free_until_ = time_ + 1e-6 / loop_->pace();
  return Event::none;
}

void LoopRun::displace(const LoopRun& from, double share) {
  state_ = from.state_;
  loop_->jump(state_, 0, share * loop_->pace() * system_.clearance());
}

void LoopRun::displace_towards(const LoopRun& other, double share) {
  state_ += share * (other.state_ - state_);
}

double LoopRun::distance(const LoopRun& other) const {
  return (state_ - other.state_).cwiseQuotient(loop_->sizes()).norm();
}

LoopHistory run_loop(const ControlLoop& of, const LoopStart& start, const SetPoint& set_point,
                     const LoopSimulationOptions& options) {
  const RealisedLoop loop(of, set_point, options.force_limit, options.tolerance, options.disturbance);
  LoopRun run(loop, start, set_point);
  LoopHistory history{{}, {}, LoopEnd::duration, options.duration, loop.error()};
  const auto end_at = [&](LoopEnd end) {
    history.end = end;
    history.end_time = run.time();
    return history;
  };
  const auto add = [&](const LoopRow& row) {
    if (options.rows_at_impacts) history.rows.push_back(row);
  };
  const bool samples = options.sample_time > 0;
  std::size_t sample = 0;
  if (samples) {
    history.rows.push_back(run.row(LoopEvent::sample));
    ++sample;
  }
  while (run.time() < options.duration) {
    const double next_sample = static_cast<double>(sample) * options.sample_time;
    const bool to_sample = samples && next_sample <= options.duration;
    switch (run.advance(to_sample ? next_sample : options.duration)) {
      case LoopRun::Event::none:
        if (run.has_diverged()) return end_at(LoopEnd::diverged);
        if (run.is_spent()) return end_at(LoopEnd::most_flights);
        if (to_sample) {
          history.rows.push_back(run.row(LoopEvent::sample));
          ++sample;
        }
        break;
      case LoopRun::Event::impact:
        add(run.row_before(LoopEvent::before_impact));
        add(run.row(LoopEvent::after_impact));
        if (run.is_in_contact()) add(run.row(LoopEvent::contact));
        history.impacts.push_back(run.last_impact());
        if (history.impacts.size() == options.most_impacts) return end_at(LoopEnd::most_impacts);
        break;
      case LoopRun::Event::contact:
        add(run.row(LoopEvent::contact));
        break;
      case LoopRun::Event::release:
        add(run.row(LoopEvent::release));
        break;
    }
    if (run.is_stuck()) return end_at(LoopEnd::rest);
  }
  return history;
}

}  // namespace backlash::detail
