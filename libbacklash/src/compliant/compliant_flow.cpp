// SPDX-License-Identifier: BSD-3-Clause
#include "compliant_flow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"

namespace backlash::detail {
namespace {

using Index = Eigen::Index;

// Only its changes move the body.
bool ignores_place(const std::optional<PlacedOperator>& memory) {
  if (!memory) return true;
  const LoopOperator& of = memory->of;
  return of.on_position == 0 && of.integral_weights.empty() &&
         std::all_of(of.modes.begin(), of.modes.end(), [](const auto& mode) { return mode.derivative > 0; });
}

}  // namespace

void require_followed(const CompliantBodies& bodies, double omega, const char* meaning) {
  constexpr double fastest = 1e6, shortest = 1e9;
  const FreeContact free = free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2());
  const double ratio = free.frequency / omega;
  if (ratio <= fastest && 2 * free.damping_ratio * ratio <= shortest) return;
  throw std::invalid_argument(
      "contact_stiffness is " + text(bodies.contact().stiffness()) + " N/m and contact_damping " +
      text(bodies.contact().damping()) + " N s/m; sqrt(k/m) must be at most 1e6 times " + meaning + " = " +
      text(omega) + " rad/s, and c/m 1e9 times: such contacts take no time, and a restitution describes them");
}

CompliantFlow::CompliantFlow(const CompliantBodies& bodies, const SineForce& force, Output output, double tolerance,
                             int harmonics)
    : bodies_(bodies),
      force_(force),
      output_(output),
      pace_(force.omega),
      half_gap_(0.5 * bodies.system().clearance()),
      harmonics_(std::max(harmonics, 1)) {
  const TwoMassSystem& system = bodies.system();
  memory_[0] = place(bodies.hard().load(), system.mass1(), tolerance, 1.0 / 3);
  memory_[1] = place(bodies.hard().drive(), system.mass2(), tolerance, 2.0 / 3);
  phasors_ = std::exchange(size_, size_ + 2 * harmonics_);
  // Of body 1 what it moves with the centre of mass: at low frequency much more than the gap.
  const double swing = std::max(system.clearance(),
                                force_.amplitude / ((system.mass1() + system.mass2()) * force_.omega * force_.omega));
  choose_sizes(swing, force_.amplitude);
  sizes_.segment(phasors_, 2 * harmonics_).setConstant(swing);
  const bool is_anywhere = ignores_place(memory_[0]) && ignores_place(memory_[1]);
  for (Index i = 0; i < phasors_; ++i) {
    if (i >= cosine && i <= one) continue;
    if (i == x1 && is_anywhere) continue;
    if (i == v1 && bodies.are_free()) continue;
    repeating_.push_back(i);
  }
}

CompliantFlow::CompliantFlow(const CompliantLoop& loop, const SetPoint& set_point, double force_limit, double tolerance,
                             double fastest, const Disturbance& disturbance)
    : bodies_(loop.bodies()),
      force_{0, set_point.sine_amplitude != 0 ? set_point.sine_omega : 0},
      output_(loop.measured()),
      set_point_(set_point),
      force_limit_(force_limit),
      disturbance_(disturbance),
      pace_(crossover(loop.hard())),
      fastest_(fastest),
      half_gap_(0.5 * loop.bodies().system().clearance()),
      harmonics_(0) {
  const TwoMassSystem& system = bodies_.system();
  if (loop.controller().delay() > 0)
    throw std::invalid_argument("the controller has a dead time of " + text(loop.controller().delay()) +
                                " s; around contacts that take time a loop has none, but in a computer");
  require_followed(bodies_, pace_, "the crossover of the rigid loop");
  memory_[0] = place(bodies_.hard().load(), system.mass1(), tolerance, 1.0 / 3);
  memory_[1] = place(bodies_.hard().drive(), system.mass2(), tolerance, 2.0 / 3);
  controller_ = place(loop.controller(), tolerance, 0);
  if (set_point_.step != 0 || set_point_.ramp != 0 || !set_point_.knots.empty())
    reference_ = std::exchange(size_, size_ + 2);
  if (set_point_.lag > 0) lagged_ = std::exchange(size_, size_ + 1);
  double swing = std::max({system.clearance(), std::abs(set_point_.step), std::abs(set_point_.sine_amplitude)});
  for (const SetPointKnot& knot : set_point_.knots) swing = std::max(swing, std::abs(knot.value));
  choose_sizes(swing, (system.mass1() + system.mass2()) * swing * pace_ * pace_);
  controller_->scale(sizes_, swing, pace_);
  if (reference_ >= 0) sizes_.segment(reference_, 2) << swing, swing * pace_;
  if (lagged_ >= 0) sizes_[lagged_] = swing;
  for (Index i = 0; i < size_; ++i)
    if (i < cosine || i > one) repeating_.push_back(i);
}

// The force is the cosine of an angle that stands still.
CompliantFlow::CompliantFlow(const CompliantBodies& bodies, const HeldForce& force, const Disturbance& disturbance)
    : bodies_(bodies),
      force_{force.size, 0},
      output_(Output::x1),
      disturbance_(disturbance),
      pace_(force.pace),
      half_gap_(0.5 * bodies.system().clearance()),
      harmonics_(0) {
  require_followed(bodies_, pace_, "the crossover of the rigid loop");
  constexpr double tolerance = 1e-9;
  memory_[0] = place(bodies.hard().load(), bodies.system().mass1(), tolerance, 1.0 / 3);
  memory_[1] = place(bodies.hard().drive(), bodies.system().mass2(), tolerance, 2.0 / 3);
  choose_sizes(force.swing, force.size);
}

// Of the gap also the overlap under the force.
void CompliantFlow::choose_sizes(double swing, double force) {
  const double length = bodies_.system().clearance();
  gap_size_ = std::max(length, force / bodies_.contact().stiffness());
  sizes_ = Eigen::VectorXd::Ones(size_);
  sizes_[gap] = gap_size_;
  sizes_[x1] = swing;
  sizes_[rate] = gap_size_ * pace_;
  sizes_[v1] = swing * pace_;
  for (const auto& memory : memory_)
    if (memory) memory->scale(sizes_, length, pace_);
}

std::optional<PlacedOperator> CompliantFlow::place(const frac::FractionalTransferFunction& receptance, double mass,
                                                   double tolerance, double shift) {
  const auto resisted = resistance(receptance, mass);
  if (!resisted) return std::nullopt;
  return place(*resisted, tolerance, shift);
}

PlacedOperator CompliantFlow::place(const frac::FractionalTransferFunction& operand, double tolerance, double shift) {
  const TwoMassSystem& system = bodies_.system();
  const double contact = std::max(fastest_, free_contact(bodies_.contact(), system.mass1(), system.mass2()).frequency);
  // Contacts are signals of their own frequency.
  const frac::FrequencyBand band{0.1 * pace_, 100 * std::max(pace_, 0.1 * contact)};
  PlacedOperator placed{realised(operand, band, tolerance, shift), size_};
  size_ += placed.size();
  error_ = std::max(error_, placed.of.error);
  return placed;
}

CompliantFlow::Row CompliantFlow::unit(Index i) const {
  Row row = Row::Zero(size_);
  row[i] = 1;
  return row;
}

const CompliantFlow::Regime& CompliantFlow::regime(const CompliantMode& mode) const {
  const int index = (((mode.limit + 1) * 3 + mode.contact + 1) * 3 + mode.slide[0] + 1) * 3 + mode.slide[1] + 1;
  std::unique_ptr<Regime>& slot = regimes_[static_cast<std::size_t>(index)];
  if (!slot) slot = make(mode);
  return *slot;
}

std::unique_ptr<CompliantFlow::Regime> CompliantFlow::make(const CompliantMode& mode) const {
  const int contact = mode.contact;
  const std::array<int, 2>& slide = mode.slide;
  const Row none = Row::Zero(size_);
  const double k = bodies_.contact().stiffness(), c = bodies_.contact().damping();
  const std::array<double, 2> mass = {bodies_.system().mass1(), bodies_.system().mass2()};
  const std::array<Row, 2> position = {unit(x1), unit(x1) + unit(gap)};
  const std::array<Row, 2> velocity = {unit(v1), unit(v1) + unit(rate)};
  std::array<Row, 2> press;
  for (const int wall : {-1, 1})
    press[wall > 0 ? 1 : 0] = wall * k * unit(gap) - k * half_gap_ * unit(one) + wall * c * unit(rate);
  // Of the loop, and its rates.
  Row asked = none, asked_rate = none, asked_acceleration = none;
  Row wanted = force_.amplitude * unit(cosine);
  const std::size_t followed = output_ == Output::x1 ? 0 : 1;
  if (controller_) {
    const double sine_rate = set_point_.sine_amplitude * force_.omega;
    asked = set_point_.sine_amplitude * unit(sine);
    asked_rate = sine_rate * unit(cosine);
    asked_acceleration = -sine_rate * force_.omega * unit(sine);
    if (reference_ >= 0) {
      asked += unit(reference_);
      asked_rate += unit(reference_ + 1);
    }
    if (lagged_ >= 0) {
      const Row lagged_rate = (asked - unit(lagged_)) / set_point_.lag;
      asked_acceleration = (asked_rate - lagged_rate) / set_point_.lag;
      asked_rate = lagged_rate;
      asked = unit(lagged_);
    }
    wanted = controller_->output(asked - position[followed], asked_rate - velocity[followed]);
  }
  const Row drive = mode.limit == 0 ? wanted : Row(mode.limit * force_limit_ * unit(one));
  // Of the contact on body 1.
  const Row push = contact == 0 ? none : Row(contact * press[contact > 0 ? 1 : 0]);
  std::array<Row, 2> resisted = {none, none}, others, acceleration;
  for (std::size_t i = 0; i < 2; ++i) {
    if (memory_[i]) resisted[i] = memory_[i]->output(position[i], velocity[i]);
    const double disturbance = i == 0 ? disturbance_.body1 : disturbance_.body2;
    others[i] = (i == 0 ? push : Row(drive - push)) - resisted[i] + disturbance * unit(one);
    const double friction = this->friction(static_cast<int>(i));
    acceleration[i] = slide[i] == 0 ? none : Row((others[i] - slide[i] * friction * unit(one)) / mass[i]);
  }

  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size_, size_);
  a.row(gap) = unit(rate);
  a.row(rate) = acceleration[1] - acceleration[0];
  a.row(x1) = unit(v1);
  a.row(v1) = acceleration[0];
  a.row(cosine) = -force_.omega * unit(sine);
  a.row(sine) = force_.omega * unit(cosine);
  for (std::size_t i = 0; i < 2; ++i)
    if (memory_[i]) memory_[i]->fill(a, position[i], velocity[i], acceleration[i]);
  if (controller_)
    controller_->fill(a, asked - position[followed], asked_rate - velocity[followed],
                      asked_acceleration - acceleration[followed]);
  if (lagged_ >= 0) a.row(lagged_) = asked_rate;
  if (reference_ >= 0) a.row(reference_) = unit(reference_ + 1);
  const Row& read = velocity[followed];
  for (int k1 = 1; k1 <= harmonics_; ++k1) {
    const Index at = phasors_ + 2 * (k1 - 1);
    a.row(at) = read - k1 * force_.omega * unit(at + 1);
    a.row(at + 1) = k1 * force_.omega * unit(at);
  }

  // In contact speeds are those of its own oscillation, which then is balanced.  Its modes stay among the slow ones, as
  // telling them apart would lose a digit or two, unless long contacts would take too many short steps.
  constexpr double most_skew = 16, slow_contact = 300;
  Eigen::VectorXd sizes = sizes_;
  double pace = pace_;
  if (contact != 0) {
    const double fast = std::max(pace, free_contact(bodies_.contact(), mass[0], mass[1]).frequency);
    sizes[rate] = gap_size_ * fast;
    sizes[v1] = std::max(sizes[v1], sizes[rate]);
    pace = std::min(fast, slow_contact * pace);
  }
  LinearFlight flight(a, pace, sizes, controller_ && error_ > 0 ? LinearFlight::realised_skew : most_skew);
  const auto linear = [&](const Row& row) { return Linear{row, flight.form(row)}; };
  const auto body = [&](std::size_t i) {
    return Body{linear(velocity[i]), linear(acceleration[i]), linear(others[i]), resisted[i]};
  };
  Regime result{a, flight, linear(unit(gap)), {linear(press[0]), linear(press[1])}, {body(0), body(1)}, linear(wanted)};
  return std::make_unique<Regime>(std::move(result));
}

Eigen::VectorXd CompliantFlow::start(const LoopStart& at) const {
  Eigen::VectorXd state = Eigen::VectorXd::Zero(size_);
  state[gap] = at.x2 - at.x1;
  state[rate] = at.v2 - at.v1;
  state[x1] = at.x1;
  state[v1] = at.v1;
  state[cosine] = state[one] = 1;
  if (memory_[0]) memory_[0]->kick(state, 2, at.v1);
  if (memory_[1]) memory_[1]->kick(state, 2, at.v2);
  if (!controller_) return state;
  const double slope = lagged_ >= 0 ? 0 : set_point_.sine_amplitude * force_.omega;
  controller_->kick(state, 2, slope - (output_ == Output::x1 ? at.v1 : at.v2));
  if (reference_ < 0) return state;
  const double step = set_point_.step + (set_point_.knots.empty() ? 0 : set_point_.knots.front().value);
  state[reference_] = step;
  if (lagged_ >= 0)
    controller_->kick(state, 2, step / set_point_.lag);  // behind a lag a step is a bend
  else
    controller_->kick(state, 1, step);
  // A derivative that meets a step kicks body 2; an actuator of limited force has no time for that.
  if (step != 0 && lagged_ < 0 && std::isinf(force_limit_))
    strike_drive(state, controller_->of.on_velocity * step / bodies_.system().mass2());
  set_point_bends(state, set_point_.ramp);
  return state;
}

Eigen::VectorXd CompliantFlow::meeting(const SymmetricCycle& cycle) const {
  using Complex = std::complex<double>;
  Eigen::VectorXd state = Eigen::VectorXd::Zero(size_);
  state[cosine] = state[one] = 1;
  // Sums over harmonics of what jumps are in the middle of its jump.
  const std::array<double, 2> jumps = {cycle.impulse / bodies_.system().mass1(),
                                       -cycle.impulse / bodies_.system().mass2()};
  std::array<double, 2> speeds{};
  for (std::size_t i = 0; i < 2; ++i) {
    speeds[i] = -0.5 * jumps[i];
    for (const CycleHarmonic& each : cycle.harmonics)
      speeds[i] += (Complex(0, each.order * cycle.omega) * (i == 0 ? each.x1 : each.x2)).real();
  }
  for (const CycleHarmonic& each : cycle.harmonics) state[x1] += each.x1.real();
  state[v1] = speeds[0];
  state[rate] = speeds[1] - speeds[0];
  state[gap] = half_gap_;
  const auto remember = [&](const PlacedOperator& placed, std::size_t body, double sign) {
    std::vector<std::pair<double, Complex>> lines;
    for (const CycleHarmonic& each : cycle.harmonics)
      lines.emplace_back(each.order * cycle.omega, sign * (body == 0 ? each.x1 : each.x2));
    placed.remember(state, lines, sign * jumps[body]);
  };
  for (std::size_t i = 0; i < 2; ++i)
    if (memory_[i]) remember(*memory_[i], i, 1);
  remember(*controller_, output_ == Output::x1 ? 0 : 1, -1);
  return state;
}

void CompliantFlow::strike_drive(Eigen::VectorXd& state, double velocity) const {
  state[rate] += velocity;
  if (memory_[1]) memory_[1]->kick(state, 2, velocity);
  if (output_ == Output::x2) controller_->kick(state, 2, -velocity);
}

void CompliantFlow::set_point_bends(Eigen::VectorXd& state, double change_of_slope) const {
  state[reference_ + 1] += change_of_slope;
  if (lagged_ < 0) controller_->kick(state, 2, change_of_slope);
}

void CompliantFlow::hold_force(Eigen::VectorXd& state, double force) const {
  state[cosine] = force / force_.amplitude;
}

int CompliantFlow::limit_of(const Eigen::VectorXd& state) const {
  if (std::isinf(force_limit_)) return 0;
  const double wanted = regime({}).wanted.row.dot(state);
  return wanted > force_limit_ ? 1 : wanted < -force_limit_ ? -1 : 0;
}

LoopStart CompliantFlow::positions(const Eigen::VectorXd& state) {
  return {state[x1], state[v1], state[x1] + state[gap], state[v1] + state[rate]};
}

CompliantMode CompliantFlow::mode_of(const Eigen::VectorXd& state) const {
  CompliantMode mode;
  mode.limit = limit_of(state);
  const int wall = state[gap] > 0 ? 1 : -1;
  if (std::abs(state[gap]) > half_gap_) {
    const bool presses = press(regime(mode), wall).row.dot(state) > 0;
    (presses ? mode.contact : mode.left) = wall;
  }
  const std::array<double, 2> speed = {state[v1], state[v1] + state[rate]};
  for (std::size_t i = 0; i < 2; ++i) {
    const double limit = friction(static_cast<int>(i));
    if (limit == 0) continue;
    const double others = regime(mode).bodies[i].others.row.dot(state);
    mode.slide[i] = speed[i] > 0 ? 1 : speed[i] < 0 ? -1 : others > limit ? 1 : others < -limit ? -1 : 0;
    mode.is_starting[i] = speed[i] == 0 && mode.slide[i] != 0;
  }
  return mode;
}

CompliantMode CompliantFlow::turned_over(CompliantMode mode) const {
  mode.contact *= -1;
  mode.left *= -1;
  mode.limit *= -1;
  for (int i = 0; i < 2; ++i)
    if (friction(i) != 0) mode.slide[static_cast<std::size_t>(i)] *= -1;
  return mode;
}

std::vector<std::complex<double>> CompliantFlow::take_phasors(Eigen::VectorXd& state, double periods) const {
  std::vector<std::complex<double>> phasors;
  for (int k = 0; k < harmonics_; ++k) {
    const Index at = phasors_ + 2 * k;
    phasors.push_back(std::complex<double>(state[at], state[at + 1]) * (force_.omega / (std::numbers::pi * periods)));
  }
  state.segment(phasors_, 2 * harmonics_).setZero();
  state[cosine] = 1;
  state[sine] = 0;
  return phasors;
}

}  // namespace backlash::detail
