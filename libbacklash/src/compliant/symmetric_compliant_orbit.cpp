// SPDX-License-Identifier: BSD-3-Clause
#include "symmetric_compliant_orbit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "backlash/compliant_contact.hpp"
#include "steady_state/two_impact_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr Complex i1{0, 1};

struct Pair {
  double value, rate;
};

// e^{A t} of delta'' + 2 zeta nu delta' + nu^2 delta = 0.
struct Oscillator {
  Oscillator() = default;
  Oscillator(const CompliantGroups& groups, double t) {
    const double a = groups.zeta * groups.nu;
    const double square = groups.nu * groups.nu * (1 - groups.zeta) * (1 + groups.zeta);
    const double x = square * t * t;
    double c = 0, s = 0;  // e^{-a t} cos(w t) and e^{-a t} sin(w t)/w, w^2 = square
    if (std::abs(x) < 1e-2) {
      const double decay = std::exp(-a * t);
      c = decay * (1 - x / 2 * (1 - x / 12 * (1 - x / 30 * (1 - x / 56 * (1 - x / 90)))));
      s = decay * t * (1 - x / 6 * (1 - x / 20 * (1 - x / 42 * (1 - x / 72 * (1 - x / 110)))));
    } else if (square > 0) {
      const double w = std::sqrt(square), decay = std::exp(-a * t);
      c = decay * std::cos(w * t);
      s = decay * std::sin(w * t) / w;
    } else {
      const double w = std::sqrt(-square);
      const double slow = std::exp((w - a) * t), fast = std::exp(-(w + a) * t);
      c = 0.5 * (slow + fast);
      s = 0.5 * (slow - fast) / w;
    }
    vv = c + a * s;
    vr = s;
    rv = -groups.nu * groups.nu * s;
    rr = c - a * s;
  }
  [[nodiscard]] Pair operator*(Pair z) const { return {vv * z.value + vr * z.rate, rv * z.value + rr * z.rate}; }
  double vv = 1, vr = 0, rv = 0, rr = 1;
};

// Re(amplitude e^{j angle}) and its rate.
Pair forced(Complex amplitude, Complex turned) {
  const Complex z = amplitude * turned;
  return {z.real(), -z.imag()};
}

class Equations {
 public:
  explicit Equations(const CompliantGroups& groups)
      : g_(groups),
        amplitude_(groups.gamma * inverse(Complex((groups.nu - 1) * (groups.nu + 1), 2 * groups.zeta * groups.nu))) {}

  void set(double angle, double speed, double duration) {
    angle_ = angle;
    speed_ = speed;
    duration_ = duration;
    begin_ = std::polar(1.0, angle);
    end_ = std::polar(1.0, angle + duration);
    const Pair begin = forced(amplitude_, begin_), end = forced(amplitude_, end_);
    const Oscillator flow(g_, duration);
    flow_ = flow;
    start_ = {-begin.value, speed - begin.rate};
    const Pair free = flow * start_;
    delta_ = free.value + end.value;
    rate_ = free.rate + end.rate;
    cosine_ = end_.real();
    sine_ = end_.imag();
    const double bend = g_.gamma * cosine_ - press(delta_, rate_);
    // Derivatives of the end of contact by speed, angle and duration.
    const Pair by_speed = flow * Pair{0, 1};
    // The second rate of a forced part is its negative.
    const Pair by_start = flow * Pair{-begin.rate, begin.value};
    const Pair by_angle{by_start.value + end.rate, by_start.rate - end.value};
    const double left = pi - duration, gamma = g_.gamma;
    const double cos0 = begin_.real(), sin0 = begin_.imag();
    kick_ = rate_ - gamma * sine_;  // velocity of the free flight less its forced part
    miss_ = {kick_ - gamma * sin0 + speed, 1 + delta_ + kick_ * left + gamma * (cos0 + cosine_), press(delta_, rate_)};
    const auto column = [&](std::size_t k, Pair d, double cosine_rate, double sine_rate, double left_rate,
                            double own_rate, double own_gap) {
      const double kick = d.rate - gamma * sine_rate;
      jacobian_[0][k] = kick + own_rate;
      jacobian_[1][k] = d.value + kick * left + kick_ * left_rate + gamma * cosine_rate + own_gap;
      jacobian_[2][k] = press(d.value, d.rate);
    };
    column(0, by_angle, -sine_, cosine_, 0, -gamma * cos0, -gamma * sin0);
    column(1, by_speed, 0, 0, 0, 1, 0);
    column(2, {rate_, bend}, -sine_, cosine_, -1, 0, 0);
  }

  [[nodiscard]] double residual() const {
    return std::max({std::abs(miss_[0]), std::abs(miss_[1]), std::abs(miss_[2]) / (g_.nu * g_.nu)});
  }
  // By Cramer's rule. @return false where there is no step
  [[nodiscard]] bool step(std::array<double, 3>& change) const {
    const auto& j = jacobian_;
    const auto determinant = [](const std::array<std::array<double, 3>, 3>& a) {
      return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
             a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    };
    const double whole = determinant(j);
    if (whole == 0 || !std::isfinite(whole)) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      auto replaced = j;
      for (std::size_t r = 0; r < 3; ++r) replaced[r][k] = -miss_[r];
      change[k] = determinant(replaced) / whole;
    }
    return true;
  }

  // The wall presses from the start to the end of the contact: no interval is left in which the bound of its second
  // rate would let the force fall to 0.
  [[nodiscard]] bool presses_throughout() const {
    const double push = press(0, speed_), bend = g_.gamma * cosine_ - press(delta_, rate_);
    const Pair at_start{push, press(speed_, g_.gamma * begin_.real() - push)};
    const Pair at_end{press(delta_, rate_), press(rate_, bend)};
    if (is_one_swing(at_start.value)) return true;
    const double nu = g_.nu, size = std::hypot(nu * start_.value, start_.rate) + g_.nu * 1e-300;
    // Of the second rate of the force: free part nu^3 (1 + 2 zeta) times its size, grown by no damping, and forced
    // part.
    const double bound = nu * nu * nu * (1 + 2 * g_.zeta) * (1 + 2 * g_.zeta) * (1 + 2 * g_.zeta) * size +
                         (nu * nu + 2 * g_.zeta * nu) * std::abs(amplitude_);
    return presses(0, at_start, duration_, at_end, bound, 0);
  }

  // In the free flight the gap falls all the time, and the force that a wall would have does too while bodies overlap.
  [[nodiscard]] bool meets_nothing() const {
    // Its velocity is kick + gamma sin(tau), tau from the end of contact to angle + pi, where it is -speed.
    const double from = angle_ + duration_, to = angle_ + pi;
    double highest = std::max(rate_, -speed_);
    // A maximum of the sine within.
    const double peak = pi / 2 + 2 * pi * std::ceil((from - pi / 2) / (2 * pi));
    if (peak < to) highest = std::max(highest, kick_ + g_.gamma);
    if (!(highest < 0)) return false;
    // nu^2 delta' + 2 zeta nu delta'' < 0 with delta'' <= gamma.
    return g_.zeta == 0 || nu_() * -highest > 2 * g_.zeta * g_.gamma || overlap_ends_falling();
  }

  [[nodiscard]] SymmetricCompliantOrbit orbit() const {
    SymmetricCompliantOrbit orbit{angle_, speed_, duration_, {}, 0, residual(), 0};
    const double gamma = g_.gamma, damping = 2 * g_.zeta * g_.nu, stiffness = g_.nu * g_.nu;
    // e^{-j k tau}, k = 0 to 6, where the contact begins and ends.
    std::array<Complex, 7> first{1}, last{1};
    for (std::size_t k = 1; k < first.size(); ++k) {
      first[k] = first[k - 1] * std::conj(begin_);
      last[k] = last[k - 1] * std::conj(end_);
    }
    for (std::size_t n = 0; n < orbit.contact.size(); ++n) {
      const std::size_t order = 2 * n + 1;
      const auto k = static_cast<double>(order);
      // Of e^{-j k tau} over the contact.
      const auto exponential = [&](std::size_t of) {
        if (of == 0) return Complex(duration_);
        const Complex change = (last[of] - first[of]) / static_cast<double>(of);
        return Complex(-change.imag(), change.real());
      };
      const Complex force = gamma / 2 * (exponential(order - 1) + exponential(order + 1));
      const Complex position = delta_ * last[order], rate = rate_ * last[order] - speed_ * first[order];
      // Of delta, from the equation of motion by parts.
      const Complex gap =
          (force - rate - i1 * k * position - damping * position) * inverse(Complex(stiffness - k * k, damping * k));
      orbit.contact[n] = 2 / pi * (force - rate - i1 * k * position + k * k * gap);
      // The force's work during contact less the growth of kinetic energy, in both contacts.
      if (n == 0) orbit.loss = 2 * (gamma * (position + i1 * gap).real() + 0.5 * (speed_ - rate_) * (speed_ + rate_));
    }
    // Half the map, in (gap, rate): entry keeps the gap and lowers the rate by 2 zeta nu of its change.
    const Oscillator& flow = flow_;
    const double left = pi - duration_;
    const Pair columns[2] = {flow * Pair{1, -damping}, flow * Pair{0, 1}};
    const double half_trace = columns[0].value + left * columns[0].rate + columns[1].rate;
    const double determinant = std::exp(-damping * duration_);
    const double discriminant = half_trace * half_trace / 4 - determinant;
    const double half = discriminant < 0 ? std::sqrt(determinant) : std::abs(half_trace) / 2 + std::sqrt(discriminant);
    orbit.largest_multiplier = half * half;
    return orbit;
  }

 private:
  [[nodiscard]] static Complex inverse(Complex z) { return std::conj(z) / std::norm(z); }
  // The force is e^{-a t} (C cos(w t + phase) + e^{a t} q), q of the forced part: above 0 where the cosine outweighs
  // the other, rising to there and falling from there, as it begins at 0 or more and ends at 0.  Sufficient: a force of
  // a lightly damped contact that is short against the period.
  [[nodiscard]] bool is_one_swing(double at_start) const {
    const double a = g_.zeta * g_.nu, square = g_.nu * g_.nu - a * a;
    if (!(square > 0) || at_start < 0) return false;
    const double w = std::sqrt(square), damping = 2 * g_.zeta * g_.nu, stiffness = g_.nu * g_.nu;
    // Of the free part at the start: the force, and its rate with a times it.
    const double force = stiffness * start_.value + damping * start_.rate;
    const double second = -damping * start_.rate - stiffness * start_.value;
    const double across = (stiffness * start_.rate + damping * second + a * force) / w;
    const double size = std::hypot(force, across);
    const double other = std::exp(a * duration_) * std::abs(amplitude_) * g_.nu * std::hypot(g_.nu, 2 * g_.zeta);
    const double share = other * (1 + a) / (size * w);  // of the other's rate in that of the cosine
    if (!(share < 1) || !(size * std::sqrt(1 - share * share) > other)) return false;
    const double from = std::atan2(-across, force), to = from + w * duration_, turn = std::asin(share);
    return from > turn - pi && to < pi - turn;
  }
  [[nodiscard]] double nu_() const { return g_.nu; }
  [[nodiscard]] double press(double delta, double rate) const { return g_.nu * (g_.nu * delta + 2 * g_.zeta * rate); }
  // The force of the wall and its rate.
  [[nodiscard]] Pair push_at(double t) const {
    const Complex turned = std::polar(1.0, angle_ + t);
    const Pair begin = forced(amplitude_, begin_), now = forced(amplitude_, turned);
    const Pair free = Oscillator(g_, t) * Pair{-begin.value, speed_ - begin.rate};
    const double delta = free.value + now.value, rate = free.rate + now.rate, push = press(delta, rate);
    // delta'' = gamma cos(tau) - push; that of a wall that also pulled.
    return {push, press(rate, g_.gamma * turned.real() - push)};
  }
  // Above 0 within: above what a parabola of that second rate can fall between the ends, or rising or falling all the
  // time.  The end of the contact itself is 0 but for rounding.
  [[nodiscard]] bool presses(double from, Pair at_from, double to, Pair at_to, double bound, int depth) const {
    const double width = to - from;
    if (std::min(at_from.value, at_to.value) > bound * width * width / 8) return true;
    if (at_from.value >= 0 && at_from.rate > bound * width) return true;
    if (-at_to.rate > bound * width) return true;
    if (depth == most_halvings) return false;
    const double middle = from + width / 2;
    const Pair at_middle = push_at(middle);
    if (at_middle.value <= 0) return false;
    return presses(from, at_from, middle, at_middle, bound, depth + 1) &&
           presses(middle, at_middle, to, at_to, bound, depth + 1);
  }
  // Until the overlap left is gone, sampled by its shortest time scale.
  [[nodiscard]] bool overlap_ends_falling() const {
    const double from = angle_ + duration_;
    const int steps = 64;
    const double until = std::min(pi - duration_, 4 * delta_ / std::max(-rate_, 1e-300));
    for (int n = 1; n <= steps; ++n) {
      const double t = until * n / steps, angle = from + t;
      const double gap = delta_ + kick_ * t - g_.gamma * (std::cos(angle) - cosine_);
      if (gap < 0) return true;
      if (press(gap, kick_ + g_.gamma * std::sin(angle)) > 0) return false;
    }
    return false;
  }

  static constexpr int most_halvings = 12;

  CompliantGroups g_;
  Complex amplitude_;
  double angle_ = 0, speed_ = 0, duration_ = 0;
  Complex begin_, end_;  // e^{j tau} where the contact begins and ends
  Oscillator flow_;      // over the contact
  Pair start_{};         // its free part where it begins
  double delta_ = 0, rate_ = 0, cosine_ = 0, sine_ = 0, kick_ = 0;
  std::array<double, 3> miss_{};
  std::array<std::array<double, 3>, 3> jacobian_{};
};

}  // namespace

std::optional<SymmetricCompliantOrbit> symmetric_compliant_orbit(const CompliantGroups& groups, double angle,
                                                                 double speed, double duration) {
  constexpr int most_steps = 12;
  constexpr double converged = 1e-8;  // of a step, over the duration of the contact; the next is its square
  Equations equations(groups);
  bool is_last = false;
  for (int n = 0; n <= most_steps; ++n) {
    equations.set(angle, speed, duration);
    if (is_last) break;
    std::array<double, 3> change{};
    if (n == most_steps || !equations.step(change)) return std::nullopt;
    angle += change[0];
    speed += change[1];
    duration += change[2];
    if (!(speed > 0 && duration > 0 && duration < pi)) return std::nullopt;
    is_last = std::abs(change[0]) < converged * duration && std::abs(change[1]) < converged * (1 + speed) &&
              std::abs(change[2]) < converged * duration;
  }
  if (!is_last || !(equations.residual() < 1e-10)) return std::nullopt;
  if (!equations.meets_nothing() || !equations.presses_throughout()) return std::nullopt;
  return equations.orbit();
}

std::optional<SymmetricCompliantOrbit> symmetric_compliant_orbit_from_hard(const CompliantGroups& groups) {
  constexpr double stiff = 512;
  // Of two masses of 2 kg, whose reduced mass is 1 kg, and a contact of 1 rad/s.
  const FreeContact contact = free_contact(CompliantContact::from_frequency(1, groups.zeta, 2, 2), 2, 2);
  const SymmetricFamily hard(contact.restitution);
  if (!(groups.gamma >= hard.saddle_node())) return std::nullopt;
  const SymmetricImpact impact = hard.at(groups.gamma);
  int halvings = 0;
  while (std::ldexp(groups.nu, halvings) < stiff) ++halvings;
  CompliantGroups of = groups;
  of.nu = std::ldexp(groups.nu, halvings);
  // The hard orbit's phase is that of the other wall.
  double angle = std::atan2(impact.sin_phase, impact.cos_phase) + pi;
  std::optional<SymmetricCompliantOrbit> orbit =
      symmetric_compliant_orbit(of, angle, impact.speed, contact.duration / of.nu);
  for (; orbit && halvings > 0; --halvings) {
    of.nu /= 2;
    // In first order of 1/nu.
    const double before_angle = angle, shift = orbit->angle - before_angle;
    angle = orbit->angle;
    orbit = symmetric_compliant_orbit(of, orbit->angle + shift, orbit->speed, 2 * orbit->duration);
  }
  return orbit;
}

}  // namespace backlash::detail
