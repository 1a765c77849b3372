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

void require_followed(const CompliantBodies& bodies, double omega) {
  constexpr double fastest = 1e6, shortest = 1e9;
  const FreeContact free = free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2());
  const double ratio = free.frequency / omega;
  if (ratio <= fastest && 2 * free.damping_ratio * ratio <= shortest) return;
  throw std::invalid_argument(
      "contact_stiffness is " + text(bodies.contact().stiffness()) + " N/m and contact_damping " +
      text(bodies.contact().damping()) + " N s/m; sqrt(k/m) must be at most 1e6 times omega = " + text(omega) +
      " rad/s, and c/m 1e9 times: such contacts take no time, and a restitution describes them");
}

CompliantFlow::CompliantFlow(const CompliantBodies& bodies, const SineForce& force, Output output, double tolerance,
                             int harmonics)
    : bodies_(bodies),
      force_(force),
      output_(output),
      half_gap_(0.5 * bodies.system().clearance()),
      harmonics_(std::max(harmonics, 1)) {
  const TwoMassSystem& system = bodies.system();
  memory_[0] = place(bodies.hard().load(), system.mass1(), tolerance, 1.0 / 3);
  memory_[1] = place(bodies.hard().drive(), system.mass2(), tolerance, 2.0 / 3);
  phasors_ = std::exchange(size_, size_ + 2 * harmonics_);
  const double length = system.clearance();
  sizes_ = Eigen::VectorXd::Ones(size_);
  // Of the gap also the overlap under the force; of body 1 what it moves with the centre of mass: at low frequency much
  // more than the gap.
  const double swing =
      std::max(length, force_.amplitude / ((system.mass1() + system.mass2()) * force_.omega * force_.omega));
  gap_size_ = std::max(length, force_.amplitude / bodies.contact().stiffness());
  sizes_[gap] = gap_size_;
  sizes_[x1] = swing;
  sizes_[rate] = gap_size_ * force_.omega;
  sizes_[v1] = swing * force_.omega;
  sizes_.segment(phasors_, 2 * harmonics_).setConstant(swing);
  for (const auto& memory : memory_)
    if (memory) memory->scale(sizes_, length, force_.omega);
  const bool is_anywhere = ignores_place(memory_[0]) && ignores_place(memory_[1]);
  for (Index i = 0; i < phasors_; ++i) {
    if (i >= cosine && i <= one) continue;
    if (i == x1 && is_anywhere) continue;
    if (i == v1 && bodies.are_free()) continue;
    repeating_.push_back(i);
  }
}

std::optional<PlacedOperator> CompliantFlow::place(const frac::FractionalTransferFunction& receptance, double mass,
                                                   double tolerance, double shift) {
  const auto resisted = resistance(receptance, mass);
  if (!resisted) return std::nullopt;
  const TwoMassSystem& system = bodies_.system();
  const double contact = free_contact(bodies_.contact(), system.mass1(), system.mass2()).frequency;
  // Contacts are signals of their own frequency.
  const frac::FrequencyBand band{0.1 * force_.omega, 100 * std::max(force_.omega, 0.1 * contact)};
  PlacedOperator placed{realised(*resisted, band, tolerance, shift), size_};
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
  const int index = (mode.contact + 1) * 9 + (mode.slide[0] + 1) * 3 + mode.slide[1] + 1;
  std::unique_ptr<Regime>& slot = regimes_[static_cast<std::size_t>(index)];
  if (!slot) slot = make(mode.contact, mode.slide);
  return *slot;
}

std::unique_ptr<CompliantFlow::Regime> CompliantFlow::make(int contact, const std::array<int, 2>& slide) const {
  const Row none = Row::Zero(size_);
  const double k = bodies_.contact().stiffness(), c = bodies_.contact().damping();
  const std::array<double, 2> mass = {bodies_.system().mass1(), bodies_.system().mass2()};
  const std::array<Row, 2> position = {unit(x1), unit(x1) + unit(gap)};
  const std::array<Row, 2> velocity = {unit(v1), unit(v1) + unit(rate)};
  std::array<Row, 2> press;
  for (const int wall : {-1, 1})
    press[wall > 0 ? 1 : 0] = wall * k * unit(gap) - k * half_gap_ * unit(one) + wall * c * unit(rate);
  // Of the contact on body 1.
  const Row push = contact == 0 ? none : Row(contact * press[contact > 0 ? 1 : 0]);
  std::array<Row, 2> resisted = {none, none}, others, acceleration;
  for (std::size_t i = 0; i < 2; ++i) {
    if (memory_[i]) resisted[i] = memory_[i]->output(position[i], velocity[i]);
    others[i] = (i == 0 ? push : Row(force_.amplitude * unit(cosine) - push)) - resisted[i];
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
  const Row& read = velocity[output_ == Output::x1 ? 0 : 1];
  for (int k1 = 1; k1 <= harmonics_; ++k1) {
    const Index at = phasors_ + 2 * (k1 - 1);
    a.row(at) = read - k1 * force_.omega * unit(at + 1);
    a.row(at + 1) = k1 * force_.omega * unit(at);
  }

  // In contact speeds are those of its own oscillation, which then is balanced.  Its modes stay among the slow ones, as
  // telling them apart would lose a digit or two, unless long contacts would take too many short steps.
  constexpr double most_skew = 16, slow_contact = 300;
  Eigen::VectorXd sizes = sizes_;
  double pace = force_.omega;
  if (contact != 0) {
    const double fast = std::max(pace, free_contact(bodies_.contact(), mass[0], mass[1]).frequency);
    sizes[rate] = gap_size_ * fast;
    sizes[v1] = std::max(sizes[v1], sizes[rate]);
    pace = std::min(fast, slow_contact * pace);
  }
  LinearFlight flight(a, pace, sizes, most_skew);
  const auto linear = [&](const Row& row) { return Linear{row, flight.form(row)}; };
  const auto body = [&](std::size_t i) {
    return Body{linear(velocity[i]), linear(acceleration[i]), linear(others[i]), resisted[i]};
  };
  Regime result{a, flight, linear(unit(gap)), {linear(press[0]), linear(press[1])}, {body(0), body(1)}};
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
  return state;
}

LoopStart CompliantFlow::positions(const Eigen::VectorXd& state) {
  return {state[x1], state[v1], state[x1] + state[gap], state[v1] + state[rate]};
}

CompliantMode CompliantFlow::mode_of(const Eigen::VectorXd& state) const {
  CompliantMode mode;
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
