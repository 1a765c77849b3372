// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/two_mass_plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/check.hpp"

namespace backlash {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();

// First t > 0 at which distance + rate t + acceleration t^2/2 falls to 0, and the speed there.
struct Fall {
  double after;
  double speed;
};
Fall fall(double distance, double rate, double acceleration) {
  const double square = rate * rate - 2 * acceleration * distance;
  if (square < 0 || (rate >= 0 && acceleration >= 0)) return {never, 0};
  const double speed = std::sqrt(square);
  // The one of the two forms of the root without cancellation.
  return {rate < 0 ? 2 * distance / (speed - rate) : (rate + speed) / -acceleration, speed};
}

void require_finite(const std::string& quantity, const char* unit, double value) {
  if (!std::isfinite(value)) {
    throw std::invalid_argument(quantity + " is " + detail::text(value) + "; it must be finite (" + unit + ")");
  }
}

}  // namespace

TwoMassPlant::TwoMassPlant(const TwoMassSystem& system, const TwoMassState& start)
    : system_(system),
      total_mass_(system.mass1() + system.mass2()),
      reduced_mass_(system.mass1() / total_mass_ * system.mass2()) {
  require_finite("start.position1", "m", start.position1);
  require_finite("start.position2", "m", start.position2);
  require_finite("start.velocity1", "m/s", start.velocity1);
  require_finite("start.velocity2", "m/s", start.velocity2);
  const double gap = start.position2 - start.position1;
  if (!(gap >= 0 && gap <= system.clearance())) {
    throw std::invalid_argument("start.position2 - start.position1 is " + detail::text(gap) +
                                "; it must be in [0, clearance = " + detail::text(system.clearance()) + "] (m)");
  }
  const double share2 = system.mass2() / total_mass_;
  centre_ = start.position1 + share2 * gap;
  centre_rate_ = start.velocity1 + share2 * (start.velocity2 - start.velocity1);
  at_far_ = gap > system.clearance() / 2;
  distance_ = at_far_ ? system.clearance() - gap : gap;
  rate_ = (at_far_ ? -1 : 1) * (start.velocity2 - start.velocity1);
  if (system.clearance() == 0) {
    // Without clearance the masses are one body.
    if (rate_ != 0) energy_loss_ = 0.5 * reduced_mass_ * rate_ * rate_;
    rate_ = 0;
    is_joined_ = true;
  } else if (distance_ == 0 && rate_ < 0) {
    hit(-rate_);
  }
}

void TwoMassPlant::hit(double speed) noexcept {
  distance_ = 0;
  rate_ = system_.restitution() * speed;
  energy_loss_ += impact_energy_loss(system_, speed);
  ++impacts_;
}

// Hops from the wall that stay short of the other one, all of them under the same pressure: hop k starts with rate
// eps^k v and lasts 2 eps^k v/pressure.  Returns the time that is left when they have ended in rest, or 0.
double TwoMassPlant::hop_along_wall(double pressure, double duration) noexcept {
  const double restitution = system_.restitution();
  const double first = 2 * rate_ / pressure;
  const double all = restitution < 1 ? first / (1 - restitution) : never;
  if (all <= duration) {
    // Every impact takes its share of the kinetic energy, until there is none left.
    energy_loss_ += 0.5 * reduced_mass_ * rate_ * rate_;
    ++impacts_;
    rate_ = 0;
    distance_ = 0;
    return duration - all;
  }
  double hops = 0;
  double passed = 0;
  if (restitution == 1) {
    const double rest = std::fmod(duration, first);
    passed = duration - rest;
    hops = std::round(passed / first);
  } else if (first < duration) {
    hops = std::floor(std::log1p(-duration / all) / std::log(restitution));
    passed = -all * std::expm1(hops * std::log(restitution));
    // Rounding may put the last hop's end behind the duration.
    if (passed > duration) {
      hops -= 1;
      passed = -all * std::expm1(hops * std::log(restitution));
    }
  }
  const double before = rate_;
  rate_ *= std::pow(restitution, hops);
  energy_loss_ += 0.5 * reduced_mass_ * (before - rate_) * (before + rate_);
  impacts_ += static_cast<std::uint64_t>(hops);
  const double rest = std::clamp(duration - passed, 0.0, 2 * rate_ / pressure);
  distance_ = std::max(0.0, rest * (rate_ - 0.5 * pressure * rest));
  rate_ -= pressure * rest;
  if (distance_ == 0 && rate_ < 0) hit(-rate_);
  return 0;
}

void TwoMassPlant::move_gap(double acceleration, double duration) {
  const double clearance = system_.clearance();
  double left = duration;
  is_joined_ = false;
  while (left > 0) {
    const double away = at_far_ ? -acceleration : acceleration;
    if (distance_ == 0 && rate_ == 0 && away <= 0) {
      is_joined_ = true;
      return;
    }
    const Fall back = distance_ == 0 ? Fall{never, 0} : fall(distance_, rate_, away);
    const Fall across = fall(clearance - distance_, -rate_, -away);
    if (distance_ == 0 && away < 0 && across.after == never) {
      left = hop_along_wall(-away, left);
      continue;
    }
    const Fall& first = back.after <= across.after ? back : across;
    if (first.after > left) {
      distance_ = std::clamp(distance_ + left * (rate_ + 0.5 * away * left), 0.0, clearance);
      rate_ += away * left;
      // A contact within rounding of the end of the sample.
      if (distance_ == 0 && rate_ < 0) hit(-rate_);
      if (distance_ == clearance && rate_ > 0) {
        at_far_ = !at_far_;
        hit(rate_);
      }
      return;
    }
    left -= first.after;
    if (&first == &across) at_far_ = !at_far_;
    hit(first.speed);
  }
  const double away = at_far_ ? -acceleration : acceleration;
  is_joined_ = distance_ == 0 && rate_ == 0 && away <= 0;
}

void TwoMassPlant::advance(double force, double duration) {
  require_finite("force", "N", force);
  detail::require_not_negative("duration", "s", duration);
  const double acceleration = force / system_.mass2();
  if (system_.clearance() > 0) {
    constexpr double most = 1e7;
    const double fastest = std::sqrt(rate_ * rate_ + 2 * std::abs(acceleration) * system_.clearance());
    if (!(fastest * duration <= most * system_.clearance())) {
      throw std::invalid_argument("duration is " + detail::text(duration) + " s at relative speeds up to " +
                                  detail::text(fastest) + " m/s; the clearance of " +
                                  detail::text(system_.clearance()) + " m must not be crossed more than 1e7 times");
    }
    move_gap(acceleration, duration);
  }
  const double common = force / total_mass_;
  centre_ += duration * (centre_rate_ + 0.5 * common * duration);
  centre_rate_ += common * duration;
}

double TwoMassPlant::gap() const noexcept {
  return at_far_ ? system_.clearance() - distance_ : distance_;
}

double TwoMassPlant::gap_rate() const noexcept {
  return at_far_ ? -rate_ : rate_;
}

TwoMassState TwoMassPlant::state() const noexcept {
  const double share1 = system_.mass1() / total_mass_;
  const double share2 = system_.mass2() / total_mass_;
  const double y = gap();
  const double y_rate = gap_rate();
  return {centre_ - share2 * y, centre_rate_ - share2 * y_rate, centre_ + share1 * y, centre_rate_ + share1 * y_rate};
}

double TwoMassPlant::momentum() const noexcept {
  return total_mass_ * centre_rate_;
}

double TwoMassPlant::kinetic_energy() const noexcept {
  return 0.5 * (total_mass_ * centre_rate_ * centre_rate_ + reduced_mass_ * rate_ * rate_);
}

}  // namespace backlash
