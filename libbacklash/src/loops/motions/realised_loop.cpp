// SPDX-License-Identifier: BSD-3-Clause
#include "realised_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace backlash::detail {
namespace {

using Index = Eigen::Index;
enum : Index { x1, v1, x2, v2, bodies_states };

}  // namespace

double crossover(const ControlLoop& loop) {
  const double mass = loop.system().mass1() + loop.system().mass2();
  const auto excess = [&](double log_omega) {
    const double omega = std::exp(log_omega);
    return std::log(std::abs(loop.controller().response(omega)) / (mass * omega * omega));
  };
  double high = std::log(1e12);
  for (double low = high - 0.5; low > std::log(1e-12); low -= 0.5) {
    if (excess(low) > 0) {
      for (int i = 0; i < 20; ++i) {
        const double middle = 0.5 * (low + high);
        (excess(middle) > 0 ? low : high) = middle;
      }
      return std::exp(low);
    }
    high = low;
  }
  return 1;
}

RealisedLoop::RealisedLoop(const ControlLoop& loop, const SetPoint& set_point, double force_limit, double tolerance,
                           const Disturbance& disturbance)
    : system_(loop.system()),
      set_point_(set_point),
      force_limit_(force_limit),
      disturbance_(disturbance),
      delay_(loop.controller().delay()),
      is_driven_(loop.measured() == Output::x2),
      pace_(crossover(loop)),
      band_{0.1 * pace_, 100 * pace_} {
  if (is_driven_ && delay_ > 0) {
    throw std::invalid_argument("a loop with the driven body measured (x2) and a dead time is not simulated");
  }
  const auto states = [&](Index count) { return std::exchange(size_, size_ + count); };
  states(bodies_states);
  if (std::isfinite(force_limit_) || disturbance_.body1 != 0 || disturbance_.body2 != 0) one_ = states(1);
  if (set_point_.step != 0 || set_point_.ramp != 0 || !set_point_.knots.empty()) reference_ = states(2);
  if (set_point_.sine_amplitude != 0) sine_ = states(2);
  if (set_point_.lag > 0) lagged_ = states(1);
  if (delay_ > 0) twin_ = states(2);
  place_bodies(loop.bodies(), tolerance);
  controller_ = place(loop.controller(), 0, tolerance);
  choose_scale();
}

RealisedLoop::RealisedLoop(const LinearBodies& bodies, const SineForce& force, Output output, double tolerance)
    : system_(bodies.system()),
      force_limit_(std::numeric_limits<double>::infinity()),
      is_driven_(output == Output::x2),
      pace_(force.omega),
      band_{0.1 * pace_, 100 * pace_},
      sine_force_(force.amplitude) {
  size_ = bodies_states;
  sine_ = std::exchange(size_, size_ + 2);
  phasor_ = std::exchange(size_, size_ + 2);
  set_point_.sine_omega = force.omega;
  place_bodies(bodies, tolerance);
  choose_scale();
}

void RealisedLoop::place_bodies(const LinearBodies& of, double tolerance) {
  if (const auto resisted = resistance(of.load(), system_.mass1())) {
    load_ = place(*resisted, 1.0 / 3, tolerance);
    if (has_twin()) twin_load_ = place(*resisted, 1.0 / 3, tolerance);
  }
  if (const auto resisted = resistance(of.drive(), system_.mass2())) drive_ = place(*resisted, 2.0 / 3, tolerance);
}

void RealisedLoop::choose_scale() {
  const double length = system_.clearance();
  scale_ = Eigen::VectorXd::Ones(size_);
  scale_[x1] = scale_[x2] = length;
  scale_[v1] = scale_[v2] = length * pace_;
  for (const Index pair : {reference_, sine_, twin_}) {
    if (pair < 0) continue;
    scale_[pair] = length;
    scale_[pair + 1] = length * pace_;
  }
  if (!controller_) scale_.segment(sine_, 2) << 1, pace_;
  if (phasor_ >= 0) scale_.segment(phasor_, 2).setConstant(length / pace_);
  if (lagged_ >= 0) scale_[lagged_] = length;
  if (one_ >= 0) {
    const double force = std::isfinite(force_limit_)
                             ? force_limit_
                             : std::max(std::abs(disturbance_.body1), std::abs(disturbance_.body2));
    scale_[one_] = system_.mass2() * length * pace_ * pace_ / force;
  }
  for (const std::optional<PlacedOperator>* placed : {&load_, &drive_, &twin_load_, &controller_}) {
    if (*placed) (*placed)->scale(scale_, length, pace_);
  }
}

PlacedOperator RealisedLoop::place(const frac::FractionalTransferFunction& operand, double shift, double tolerance) {
  PlacedOperator placed{realised(operand, band_, tolerance, shift), size_};
  size_ += placed.size();
  error_ = std::max(error_, placed.of.error);
  return placed;
}

RealisedLoop::Row RealisedLoop::unit(Index i) const {
  Row row = Row::Zero(size_);
  row[i] = 1;
  return row;
}

std::unique_ptr<RealisedLoop::Regime> RealisedLoop::make(Mode mode) const {
  const double mass1 = system_.mass1(), mass2 = system_.mass2();
  const Row none = Row::Zero(size_);
  // The signal that the controller follows.
  const Index followed = is_driven_ ? Index{x2} : has_twin() ? twin_ : Index{x1};
  Row asked = none, asked_rate = none, asked_acceleration = none;
  if (reference_ >= 0) {
    asked += unit(reference_);
    asked_rate += unit(reference_ + 1);
  }
  if (sine_ >= 0) {
    asked += unit(sine_);
    asked_rate += unit(sine_ + 1);
    asked_acceleration = -set_point_.sine_omega * set_point_.sine_omega * unit(sine_);
  }
  const Row sine_acceleration = asked_acceleration;
  if (lagged_ >= 0) {
    const Row rate = (asked - unit(lagged_)) / set_point_.lag;
    asked_acceleration = (asked_rate - rate) / set_point_.lag;
    asked_rate = rate;
    asked = unit(lagged_);
  }
  const Row error = asked - unit(followed), error_rate = asked_rate - unit(followed + 1);
  const Row wanted = controller_ ? controller_->output(error, error_rate) : Row(sine_force_ * unit(sine_));
  Row resisted1 = load_ ? load_->output(unit(x1), unit(v1)) : none;
  Row resisted2 = drive_ ? drive_->output(unit(x2), unit(v2)) : none;
  if (one_ >= 0) {
    resisted1 -= disturbance_.body1 * unit(one_);
    resisted2 -= disturbance_.body2 * unit(one_);
  }
  const Row force = mode.limit == Limit::none   ? wanted
                    : mode.limit == Limit::high ? Row(force_limit_ * unit(one_))
                                                : Row(-force_limit_ * unit(one_));
  const Row free1 = -resisted1 / mass1;
  const Row free2 = (force - resisted2) / mass2;
  const Row together = (force - resisted1 - resisted2) / (mass1 + mass2);
  const Row acceleration1 = mode.contact ? together : free1;
  const Row acceleration2 = mode.contact ? together : free2;
  const Row twin_resisted = twin_load_ ? twin_load_->output(unit(twin_), unit(twin_ + 1)) : none;
  const Row twin_acceleration = -twin_resisted / mass1;

  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size_, size_);
  a.row(x1) = unit(v1);
  a.row(v1) = acceleration1;
  a.row(x2) = unit(v2);
  a.row(v2) = acceleration2;
  if (reference_ >= 0) a.row(reference_) = unit(reference_ + 1);
  if (sine_ >= 0) {
    a.row(sine_) = unit(sine_ + 1);
    a.row(sine_ + 1) = sine_acceleration;
  }
  if (lagged_ >= 0) a.row(lagged_) = asked_rate;
  if (has_twin()) {
    a.row(twin_) = unit(twin_ + 1);
    a.row(twin_ + 1) = twin_acceleration;
  }
  if (load_) load_->fill(a, unit(x1), unit(v1), acceleration1);
  if (drive_) drive_->fill(a, unit(x2), unit(v2), acceleration2);
  if (twin_load_) twin_load_->fill(a, unit(twin_), unit(twin_ + 1), twin_acceleration);
  const Row followed_acceleration = is_driven_ ? acceleration2 : has_twin() ? twin_acceleration : acceleration1;
  if (controller_) controller_->fill(a, error, error_rate, asked_acceleration - followed_acceleration);
  if (phasor_ >= 0) {
    // w' = j omega w + x: e^{-j omega t} w is the integral of x e^{-j omega t}.
    a.row(phasor_) = unit(followed) - set_point_.sine_omega * unit(phasor_ + 1);
    a.row(phasor_ + 1) = set_point_.sine_omega * unit(phasor_);
  }

  LinearFlight flight(a, pace_, scale_);
  auto result = std::make_unique<Regime>(Regime{std::move(flight), {}, {}, {}, free2 - free1, wanted});
  result->gap = result->flight.form(unit(x2) - unit(x1));
  result->wanted_force = result->flight.form(wanted);
  result->contact_force = result->flight.form(mass1 * together + resisted1);
  return result;
}

const RealisedLoop::Regime& RealisedLoop::regime(Mode mode) const {
  std::unique_ptr<Regime>& slot = regimes_[static_cast<std::size_t>(mode.limit) * 2 + (mode.contact ? 1 : 0)];
  if (!slot) slot = make(mode);
  return *slot;
}

Eigen::VectorXd RealisedLoop::rest(const LoopStart& start) const {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(size_);
  state[x1] = start.x1;
  state[x2] = start.x2;
  if (one_ >= 0) state[one_] = 1;
  if (!controller_) state[sine_] = 1;
  jump(state, start.v1, start.v2);
  return state;
}

void RealisedLoop::jump(Eigen::VectorXd& state, double velocity1, double velocity2) const {
  state[v1] += velocity1;
  state[v2] += velocity2;
  if (load_) load_->kick(state, 2, velocity1);
  if (drive_) drive_->kick(state, 2, velocity2);
  if (controller_ && !has_twin()) controller_->kick(state, 2, is_driven_ ? -velocity2 : -velocity1);
}

void RealisedLoop::twin_jumps(Eigen::VectorXd& state, double velocity1) const {
  state[twin_ + 1] += velocity1;
  if (twin_load_) twin_load_->kick(state, 2, velocity1);
  controller_->kick(state, 2, -velocity1);
}

void RealisedLoop::twin_starts(Eigen::VectorXd& state, double position) const {
  state[twin_] = position;
}

void RealisedLoop::set_point_starts(Eigen::VectorXd& state) const {
  double step = set_point_.step;
  if (!set_point_.knots.empty()) step += set_point_.knots.front().value;
  if (reference_ >= 0) {
    state[reference_] += step;
    if (lagged_ >= 0) {
      // Behind a lag a step is a bend.
      controller_->kick(state, 2, step / set_point_.lag);
    } else {
      controller_->kick(state, 1, step);
      // A derivative that meets a step kicks mass 2; an actuator of limited force has no time for that.
      if (step != 0 && controller_->of.on_velocity != 0 && std::isinf(force_limit_))
        jump(state, 0, controller_->of.on_velocity * step / system_.mass2());
    }
    set_point_bends(state, set_point_.ramp);
  }
  if (controller_ && sine_ >= 0) {
    const double slope = set_point_.sine_amplitude * set_point_.sine_omega;
    state[sine_ + 1] += slope;
    if (lagged_ < 0) controller_->kick(state, 2, slope);
  }
}

std::complex<double> RealisedLoop::take_phasor(Eigen::VectorXd& state) const {
  const std::complex<double> sum(state[phasor_], state[phasor_ + 1]);
  state.segment(phasor_, 2).setZero();
  return set_point_.sine_omega / std::numbers::pi * sum;
}

void RealisedLoop::set_point_bends(Eigen::VectorXd& state, double change_of_slope) const {
  state[reference_ + 1] += change_of_slope;
  if (lagged_ < 0) controller_->kick(state, 2, change_of_slope);
}

}  // namespace backlash::detail
