// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/loops/simulate_loop.hpp"

namespace compliant_test {

using Real = long double;

/// Two bodies with viscous friction, springs to the ground, a contact that presses and does not pull, and dry friction.
struct Machine {
  double mass1 = 1, mass2 = 1, viscous1 = 0, viscous2 = 0, spring1 = 0, spring2 = 0, clearance = 0.3;
  double stiffness = 1e4, damping = 20, coulomb1 = 0, coulomb2 = 0, force = 40, omega = 20;
  /// With a controller kp e + ki int e + kd e' in place of the force, e the set-point less a position.  With a lag of
  /// the set-point it is a speed controller kd w + ki lag int w of w = e/lag less the speed, which has kp = kd/lag + ki
  /// lag.
  struct Control {
    double kp = 0, ki = 0, kd = 0, limit = std::numeric_limits<double>::infinity();
    backlash::Disturbance disturbance = {};
    backlash::SetPoint set_point = {};
    bool follows_drive = false;
  };
  std::optional<Control> control = {};

  [[nodiscard]] backlash::CompliantBodies bodies() const {
    const auto body = [](double mass, double viscous, double spring) {
      std::vector<frac::PowerTerm> terms{{mass, 2}};
      if (viscous != 0) terms.push_back({viscous, 1});
      if (spring != 0) terms.push_back({spring, 0});
      return frac::FractionalTransferFunction({{1, 0}}, terms);
    };
    return {body(mass1, viscous1, spring1),
            body(mass2, viscous2, spring2),
            clearance,
            backlash::CompliantContact(stiffness, damping),
            {coulomb1, coulomb2}};
  }
};

/// Its motion, under a force or a controller, in steps: Gragg's method with Bulirsch and Stoer's extrapolation to order
/// 12, in extended precision; the step that an event falls into is bisected.  Steps turn the fastest oscillation by 0.1
/// rad, so that one errs by 1e-19. What an event changes is decided from positions, velocities and forces anew, with no
/// table of modes.
class Integration {
 public:
  enum : std::size_t { x1, v1, x2, v2, re, im, integral, size };
  using State = std::array<Real, size>;

  explicit Integration(const Machine& machine, const backlash::LoopStart& start) : m_(machine) {
    z_ = {start.x1, start.v1, start.x2, start.v2, 0, 0, 0};
    if (std::abs(gap()) > Real(m_.clearance) / 2) {
      const int wall = gap() > 0 ? 1 : -1;
      (press(z_, wall) > 0 ? wall_ : left_) = wall;
    }
    if (m_.control) held_ = limit_of(z_, 0);
    slide_ = {z_[v1] < 0 ? -1 : 1, z_[v2] < 0 ? -1 : 1};
    settle_slides();
    const Real reduced = Real(m_.mass1) * m_.mass2 / (Real(m_.mass1) + m_.mass2);
    const Real contact = std::sqrt(m_.stiffness / reduced) * (1 + m_.damping / std::sqrt(m_.stiffness * reduced));
    step_ = Real(0.2) / std::max<Real>(contact, m_.omega);
    if (m_.control) {
      // Rates of the loop are at most the sum of these.
      const Real drive = m_.mass2;
      step_ = Real(0.2) / (contact + std::sqrt(m_.control->kp / drive) + m_.control->kd / drive +
                           std::cbrt(m_.control->ki / drive));
    }
  }

  void advance(Real until) {
    while (time_ < until) {
      const Real length = std::min(may_turn() ? step_ / 32 : step_, until - time_);
      State next = step(length);
      if (!meets_event(next, time_ + length)) {
        z_ = next;
        time_ = length == until - time_ ? until : time_ + length;
        continue;
      }
      Real low = 0, high = length;
      while (high - low > Real(1e-17) * std::max<Real>(time_, length)) {
        const Real middle = (low + high) / 2;
        if (middle == low || middle == high) break;
        (meets_event(step(middle), time_ + middle) ? high : low) = middle;
      }
      const int contact = wall_;
      z_ = step(high);
      time_ += high;
      take_event(contact);
    }
  }

  [[nodiscard]] const State& state() const { return z_; }
  [[nodiscard]] Real time() const { return time_; }
  [[nodiscard]] int wall() const { return wall_; }
  [[nodiscard]] Real gap() const { return z_[x2] - z_[x1]; }
  [[nodiscard]] Real rate() const { return z_[v2] - z_[v1]; }
  [[nodiscard]] bool overlaps() const { return wall_ != 0 || left_ != 0; }
  /// Phasor of v1/(j omega) over the force since the last call, `periods` of the force ago.
  [[nodiscard]] std::complex<double> take_value(int periods) {
    const Real scale = 1 / (std::numbers::pi_v<Real> * periods * m_.force);
    const std::complex<double> value(static_cast<double>(z_[im] * scale), static_cast<double>(-z_[re] * scale));
    z_[re] = z_[im] = 0;
    return value;
  }

 private:
  [[nodiscard]] Real press(const State& z, int wall) const {
    return m_.stiffness * (wall * (z[x2] - z[x1]) - Real(m_.clearance) / 2) + m_.damping * (wall * (z[v2] - z[v1]));
  }
  [[nodiscard]] Real error(const State& z, Real t) const {
    const backlash::SetPoint& wanted = m_.control->set_point;
    return wanted.step + wanted.ramp * t + wanted.sine_amplitude * std::sin(Real(wanted.sine_omega) * t) -
           z[m_.control->follows_drive ? x2 : x1];
  }
  // What the integral takes in.
  [[nodiscard]] Real integrated(const State& z, Real t) const {
    const Real lag = m_.control->set_point.lag;
    return lag > 0 ? error(z, t) / lag - z[m_.control->follows_drive ? v2 : v1] : error(z, t);
  }
  [[nodiscard]] Real wanted(const State& z, Real t) const {
    const backlash::SetPoint& set = m_.control->set_point;
    if (set.lag > 0) return m_.control->kd * integrated(z, t) + m_.control->ki * set.lag * z[integral];
    const Real rate = set.ramp + set.sine_amplitude * set.sine_omega * std::cos(Real(set.sine_omega) * t) -
                      z[m_.control->follows_drive ? v2 : v1];
    return m_.control->kp * error(z, t) + m_.control->ki * z[integral] + m_.control->kd * rate;
  }
  [[nodiscard]] int limit_of(const State& z, Real t) const {
    const Real asked = wanted(z, t);
    return asked > m_.control->limit ? 1 : asked < -m_.control->limit ? -1 : 0;
  }
  // Of the piece of the motion, at whose ends a limit begins or is left.
  [[nodiscard]] Real drive(const State& z, Real t) const {
    if (!m_.control) return m_.force * std::cos(m_.omega * t);
    return held_ == 0 ? wanted(z, t) : held_ * Real(m_.control->limit);
  }
  [[nodiscard]] std::array<Real, 2> others(const State& z, Real t) const {
    const Real push = wall_ == 0 ? 0 : wall_ * press(z, wall_);
    const backlash::Disturbance disturbance = m_.control ? m_.control->disturbance : backlash::Disturbance{};
    return {disturbance.body1 + push - m_.viscous1 * z[v1] - m_.spring1 * z[x1],
            disturbance.body2 + drive(z, t) - push - m_.viscous2 * z[v2] - m_.spring2 * z[x2]};
  }
  [[nodiscard]] State field(const State& z, Real t) const {
    const auto force = others(z, t);
    const Real a1 = slide_[0] == 0 ? 0 : (force[0] - slide_[0] * m_.coulomb1) / m_.mass1;
    const Real a2 = slide_[1] == 0 ? 0 : (force[1] - slide_[1] * m_.coulomb2) / m_.mass2;
    const Real angle = m_.omega * t;
    return {z[v1], a1, z[v2], a2, z[v1] * std::cos(angle), -z[v1] * std::sin(angle), m_.control ? integrated(z, t) : 0};
  }
  [[nodiscard]] State step(Real length) const {
    constexpr std::size_t columns = 6;
    std::array<State, columns> table;
    for (std::size_t j = 0; j < columns; ++j) {
      const auto parts = static_cast<int>(2 * (j + 1));
      const Real h = length / parts;
      State before = z_, now = z_;
      const State first = field(z_, time_);
      for (std::size_t i = 0; i < size; ++i) now[i] += h * first[i];
      for (int k = 1; k < parts; ++k) {
        const State slope = field(now, time_ + k * h);
        for (std::size_t i = 0; i < size; ++i) before[i] += 2 * h * slope[i];
        std::swap(before, now);
      }
      const State last = field(now, time_ + length);
      for (std::size_t i = 0; i < size; ++i) table[j][i] = (now[i] + before[i] + h * last[i]) / 2;
      for (std::size_t k = j; k-- > 0;) {
        const Real ratio = Real((j + 1) * (j + 1)) / Real((k + 1) * (k + 1)) - 1;
        for (std::size_t i = 0; i < size; ++i) table[k][i] = table[k + 1][i] + (table[k + 1][i] - table[k][i]) / ratio;
      }
    }
    return table[0];
  }
  [[nodiscard]] Real friction(std::size_t body) const { return body == 0 ? m_.coulomb1 : m_.coulomb2; }
  [[nodiscard]] static Real speed(const State& z, std::size_t body) { return z[body == 0 ? v1 : v2]; }

  // A velocity may pass 0 and come back within a step, at whose end nothing would be seen.
  [[nodiscard]] bool may_turn() const {
    const State slope = field(z_, time_);
    for (std::size_t i = 0; i < 2; ++i)
      if (friction(i) != 0 && slide_[i] != 0 && std::abs(speed(z_, i)) < 3 * step_ * std::abs(slope[i == 0 ? v1 : v2]))
        return true;
    return false;
  }
  [[nodiscard]] bool meets_event(const State& z, Real t) const {
    const Real y = z[x2] - z[x1];
    if (wall_ != 0) {
      if (press(z, wall_) < 0) return true;
    } else if (left_ != 0) {
      if (left_ * y < Real(m_.clearance) / 2 || press(z, left_) > 0) return true;
    } else if (std::abs(y) > Real(m_.clearance) / 2) {
      return true;
    }
    if (m_.control && limit_of(z, t) != held_) return true;
    const auto force = others(z, t);
    for (std::size_t i = 0; i < 2; ++i) {
      if (friction(i) == 0) continue;
      if (slide_[i] != 0 ? slide_[i] * speed(z, i) < 0 : std::abs(force[i]) > friction(i)) return true;
    }
    return false;
  }
  void take_event(int contact) {
    const Real y = gap();
    if (contact != 0) {
      if (press(z_, contact) < 0) {
        wall_ = 0;
        left_ = contact;
      }
    } else if (left_ != 0) {
      if (press(z_, left_) > 0) {
        wall_ = left_;
        left_ = 0;
      } else if (left_ * y < Real(m_.clearance) / 2) {
        left_ = 0;
      }
    } else if (std::abs(y) > Real(m_.clearance) / 2) {
      wall_ = y > 0 ? 1 : -1;
    }
    settle_slides();
  }
  void settle_slides() {
    if (m_.control) held_ = limit_of(z_, time_);
    const auto force = others(z_, time_);
    for (std::size_t i = 0; i < 2; ++i) {
      if (friction(i) == 0) continue;
      Real& v = z_[i == 0 ? v1 : v2];
      const bool has_stopped = slide_[i] != 0 && slide_[i] * v < 0;
      if (has_stopped) v = 0;
      if (v == 0)
        slide_[i] = std::abs(force[i]) <= friction(i) ? 0 : force[i] > 0 ? 1 : -1;
      else
        slide_[i] = v > 0 ? 1 : -1;
    }
  }

  Machine m_;
  State z_{};
  Real time_ = 0, step_ = 0;
  int wall_ = 0, left_ = 0, held_ = 0;
  std::array<int, 2> slide_{1, 1};
};

}  // namespace compliant_test
