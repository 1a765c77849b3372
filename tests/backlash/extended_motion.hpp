// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

namespace reference {

/// The motion u'' = gamma cos tau between walls u = 0 and 1 in extended precision, by other means than the library: u
/// itself and the phase from the peak of the force, turning points from acos, contacts by bisection.
class ExtendedMotion {
 public:
  using Real = long double;
  static constexpr Real pi = std::numbers::pi_v<Real>;

  ExtendedMotion(Real gamma, Real restitution, Real position, Real rate)
      : gamma_(gamma), restitution_(restitution), position_(position), rate_(rate) {}

  [[nodiscard]] Real phase() const { return phase_; }  // in [0, 2 pi)
  [[nodiscard]] long turns() const { return turns_; }
  [[nodiscard]] Real position() const { return position_; }
  [[nodiscard]] Real rate() const { return rate_; }

  struct Contact {
    Real duration;
    bool far;
    Real speed;  // |u'| before
  };

  /// The next contact; empty where there is none within 60 turns.
  [[nodiscard]] std::optional<Contact> next_contact() const {
    constexpr int followed_turns = 60;
    // u' = rate + gamma (sin(phase + h) - sin phase) vanishes where the sine has this value.
    const Real level = std::sin(phase_) - rate_ / gamma_;
    std::vector<Real> ends{0};
    for (int turn = -1; turn < followed_turns; ++turn) {
      const Real base = 2 * pi * turn - phase_;
      if (std::abs(level) <= 1) {
        for (const Real at : {std::asin(level), pi - std::asin(level)}) {
          if (base + at > 0) ends.push_back(base + at);
        }
      }
      if (base > 0) ends.push_back(base);
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const Real end = position_after(ends[i]);
      if (end > 0 && end < 1) continue;
      Real before = ends[i - 1];
      Real after = ends[i];
      const bool far = end >= 1;
      for (int halving = 0; halving < 75; ++halving) {
        const Real middle = (before + after) / 2;
        const Real u = position_after(middle);
        ((far ? u >= 1 : u <= 0) ? after : before) = middle;
      }
      // A start on the wall is no contact.
      if (before == 0) continue;
      return Contact{after, far, std::abs(rate_after(after))};
    }
    return std::nullopt;
  }

  /// Goes on to the contact and through it.
  void pass(const Contact& contact) {
    phase_ += contact.duration;
    while (phase_ >= 2 * pi) {
      phase_ -= 2 * pi;
      ++turns_;
    }
    position_ = contact.far ? 1 : 0;
    rate_ = (contact.far ? -1 : 1) * restitution_ * contact.speed;
  }

 private:
  [[nodiscard]] Real position_after(Real h) const {
    const Real half = std::sin(h / 2);
    const Real h_minus_sin =
        h < 1e-2L ? h * h * h / 6 * (1 - h * h / 20 * (1 - h * h / 42 * (1 - h * h / 72))) : h - std::sin(h);
    // gamma (1 - cos h) cos phase - gamma sin phase (h - sin h), from two integrations.
    return position_ + rate_ * h + gamma_ * (std::cos(phase_) * 2 * half * half - std::sin(phase_) * h_minus_sin);
  }
  [[nodiscard]] Real rate_after(Real h) const {
    const Real half = std::sin(h / 2);
    return rate_ + gamma_ * (std::cos(phase_) * std::sin(h) - std::sin(phase_) * 2 * half * half);
  }

  Real gamma_, restitution_, position_, rate_;
  Real phase_ = 0;
  long turns_ = 0;
};

}  // namespace reference
