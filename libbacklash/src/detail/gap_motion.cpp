#include "detail/gap_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double pi_low = 1.2246467991473532e-16;  // pi - double(pi)
constexpr double half_pi = pi / 2;

struct Arcs {
  double one_minus_cos;
  double sin;
  double h_minus_sin;
};

// Taylor series below 1/2, where 1 - cos h and h - sin h cancel; the first term left out is below 1e-17 of the sum.
Arcs arcs(double h) noexcept {
  if (std::abs(h) < 0.5) {
    const double x = h * h;
    const double one_minus_cos =
        0.5 * x *
        (1 - x * (1.0 / 12) *
                 (1 - x * (1.0 / 30) *
                          (1 - x * (1.0 / 56) * (1 - x * (1.0 / 90) * (1 - x * (1.0 / 132) * (1 - x * (1.0 / 182)))))));
    const double h_minus_sin =
        h * x * (1.0 / 6) *
        (1 -
         x * (1.0 / 20) *
             (1 - x * (1.0 / 42) *
                      (1 - x * (1.0 / 72) * (1 - x * (1.0 / 110) * (1 - x * (1.0 / 156) * (1 - x * (1.0 / 210)))))));
    return {one_minus_cos, h - h_minus_sin, h_minus_sin};
  }
  const double s = std::sin(h);
  const double c = std::cos(h);
  return {1 - c, s, h - s};
}

// Starting value for the fraction of a monotone piece of motion after which it has covered the share y of its length:
// inverts the cubic that begins with `slope` (in lengths per piece) and ends with 0, by one Newton step from a blend of
// its cases slope 0 and 2.
double cubic_fraction(double y, double slope) noexcept {
  const double share = std::clamp(y, 0.0, 1.0);
  const double near = std::min(share, 1 - share);
  const double root = std::sqrt(near * (1.0 / 3)) * (1 + 0.45 * near);
  const double both_at_rest = share <= 0.5 ? root : 1 - root;
  const double blend = std::min(0.5 * slope, 1.0);
  const double t = both_at_rest + blend * (1 - std::sqrt(1 - share) - both_at_rest);
  const double value = t * (slope + t * (3 - 2 * slope + t * (slope - 2)));
  const double rate = slope + t * (6 - 4 * slope + t * (3 * slope - 6));
  return rate > 0 ? std::clamp(t - (value - share) / rate, 0.0, 1.0) : t;
}

// Root of distance(h) = target on [lower, upper], where the distance is monotone and brackets the target: Householder's
// iteration of fourth order inside a shrinking bracket.
struct Root {
  double h;
  double velocity;
};
Root monotone_root(const GapState& start, const Flight& flight, double target, double lower, double upper, double guess,
                   bool rising) noexcept {
  const double push = flight.push;
  const double pull = flight.pull;
  const double offset = start.distance - target;
  double h = guess >= lower && guess <= upper ? guess : 0.5 * (lower + upper);
  double velocity = 0;
  for (int iteration = 0; iteration < 200; ++iteration) {
    const Arcs a = arcs(h);
    const double residual = offset + start.velocity * h + push * a.one_minus_cos + pull * a.h_minus_sin;
    velocity = start.velocity + push * a.sin + pull * a.one_minus_cos;
    const double acceleration = push * (1 - a.one_minus_cos) + pull * a.sin;
    const double jerk = pull * (1 - a.one_minus_cos) - push * a.sin;
    ((residual < 0) == rising ? lower : upper) = h;
    const double inverse = 1 / velocity;
    const double newton = residual * inverse;
    const double curvature = acceleration * inverse;
    const double twist = jerk * inverse;
    const double bend = newton * curvature;
    // Far from the root, as where the velocity is almost lost on the way, the series behind the iteration means
    // nothing.
    const bool is_near = std::abs(bend) + newton * newton * std::abs(twist) < 1;
    const double step =
        is_near ? -newton * (1 - 0.5 * bend) / (1 - bend + newton * newton * twist * (1.0 / 6)) : -newton;
    // The error that the step leaves is about step (step m)^3, 1/m the length over which the velocity changes by
    // itself.
    const double turned = step * step * (curvature * curvature + std::abs(twist));
    if (is_near && step * step * turned * turned * turned <= 1e-33 * h * h) {
      const double next = std::clamp(h + step, lower, upper);
      const double last = next - h;
      velocity += last * (acceleration + last * (0.5 * jerk - last * acceleration * (1.0 / 6)));
      return {next, velocity};
    }
    double next = h + step;
    if (!(next > lower && next < upper) || iteration % 8 == 7) next = 0.5 * (lower + upper);
    if (next == h) break;
    h = next;
  }
  return {h, velocity};
}

// A hop so short that the force presses towards the wall all through it: distance(h)/h falls to its single root, which
// lies below 2.5 velocity/|push| because the push of a sine shrinks at most linearly on its way to the reversal.
bool short_hop(const GapState& start, Flight& flight, double to_reversal) noexcept {
  const double pressure = -flight.push;
  const double limit = 2.5 * start.velocity / pressure;
  if (!(limit < 0.5 * to_reversal && limit < 0.5 && start.velocity * limit < 1)) return false;
  double h = 0.8 * limit;
  double velocity = 0;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Arcs a = arcs(h);
    const double mean_velocity = start.velocity + (flight.push * a.one_minus_cos + flight.pull * a.h_minus_sin) / h;
    velocity = start.velocity + flight.push * a.sin + flight.pull * a.one_minus_cos;
    const double step = -mean_velocity * h / (velocity - mean_velocity);
    const double next = std::clamp(h + step, 0.5 * h, 1.25 * limit);
    velocity += (next - h) * (flight.push * (1 - a.one_minus_cos) + flight.pull * a.sin);
    const bool done = std::abs(next - h) <= 1e-8 * h;
    h = next;
    if (done) break;
  }
  flight.hits = true;
  flight.crosses = false;
  flight.duration = h;
  flight.speed = std::abs(velocity);
  return true;
}

// At the reversal itself the force that is about to grow counts.
bool is_pushed_to_wall(const GapState& state) noexcept {
  const double push = state.parity() * state.sin_s;
  return push < 0 || (push == 0 && state.parity() * state.cos_s < 0);
}

}  // namespace

GapState state_at_peak(double position, double position_rate) {
  GapState state;
  state.half_period = 1;
  state.s = -half_pi;
  state.sin_s = -1;
  state.cos_s = 0;
  state.wall = position <= 0.5 ? 0 : 1;
  state.distance = state.wall == 0 ? position : 1 - position;
  state.velocity = state.wall == 0 ? position_rate : -position_rate;
  return state;
}

void advance_phase(GapState& state, double h) noexcept {
  const double s = state.s + h;
  const double turns = std::floor((s + half_pi) / pi);
  state.s = (s - turns * pi) - turns * pi_low;
  state.half_period += static_cast<std::int64_t>(turns);
  state.sin_s = std::sin(state.s);
  state.cos_s = std::cos(state.s);
}

double radians_to_half_period(const GapState& state, std::int64_t half_period) noexcept {
  return static_cast<double>(half_period - state.half_period) * pi - half_pi - state.s;
}

bool GapMotion::rests(const GapState& state) const noexcept {
  return state.distance <= 0 && state.velocity <= 0 && is_pushed_to_wall(state);
}

GapState GapMotion::release_after(const GapState& rest) const noexcept {
  GapState state = rest;
  if (rest.parity() < 0) ++state.half_period;
  state.s = 0;
  state.sin_s = 0;
  state.cos_s = 1;
  state.distance = 0;
  state.velocity = 0;
  return state;
}

DistanceAndVelocity GapMotion::along(const GapState& start, const Flight& flight, double h) const noexcept {
  const Arcs a = arcs(h);
  return {start.distance + start.velocity * h + flight.push * a.one_minus_cos + flight.pull * a.h_minus_sin,
          start.velocity + flight.push * a.sin + flight.pull * a.one_minus_cos};
}

Flight GapMotion::next_flight(GapState& start) const noexcept {
  const bool starts_backwards =
      start.velocity < 0 || (start.velocity == 0 && start.distance > 0 && is_pushed_to_wall(start));
  if (starts_backwards) {
    start.wall = 1 - start.wall;
    start.distance = 1 - start.distance;
    start.velocity = start.velocity == 0 ? 0 : -start.velocity;
  }
  const double parity = start.parity();
  Flight flight;
  flight.push = parity * gamma_ * start.sin_s;
  flight.pull = parity * gamma_ * start.cos_s;

  if (start.distance == 0 && flight.push < 0 && short_hop(start, flight, start.s < 0 ? -start.s : pi - start.s)) {
    return flight;
  }

  // velocity(h) = parity gamma (A - cos(s + h)) with A = cos s + parity velocity/gamma vanishes at s + h = +-theta + 2
  // pi n, theta = acos A; 1 - A without cancellation at small s.
  const double one_minus_a = start.sin_s * start.sin_s / (1 + start.cos_s) - parity * start.velocity / gamma_;
  const double drift = parity * gamma_ * (1 - one_minus_a);  // mean velocity
  const double limit = 2 * pi * static_cast<double>(max_free_periods);

  if (one_minus_a < 0 || one_minus_a > 2) {
    // The velocity never vanishes, so the opposite wall is met in the period in which the mean motion brings it there.
    const double room = 1 - start.distance;
    const double periods = std::max(0.0, std::floor(room / (2 * pi * drift)) - 1);
    double lower = 2 * pi * periods;
    if (!(lower < limit)) return flight;
    while (along(start, flight, lower + 2 * pi).distance < 1) {
      lower += 2 * pi;
      if (!(lower < limit)) return flight;
    }
    const double from = along(start, flight, lower).distance;
    const double to = along(start, flight, lower + 2 * pi).distance;
    const double guess = lower + 2 * pi * std::clamp((1 - from) / (to - from), 0.0, 1.0);
    const Root root = monotone_root(start, flight, 1, lower, lower + 2 * pi, guess, true);
    flight.hits = flight.crosses = true;
    flight.duration = root.h;
    flight.speed = std::max(0.0, root.velocity);
    return flight;
  }

  double theta;
  if (one_minus_a < 0.5) {
    theta = 2 * std::asin(std::sqrt(one_minus_a / 2));
  } else if (one_minus_a > 1.5) {
    theta = pi - 2 * std::asin(std::sqrt((2 - one_minus_a) / 2));
  } else {
    theta = std::acos(1 - one_minus_a);
  }
  // The velocity is positive now; it ends being so at the first top.
  double top;
  double bottom;
  if (parity > 0) {
    top = start.s < 0 ? -theta - start.s : 2 * pi - theta - start.s;
    bottom = top + 2 * theta;
  } else {
    top = theta - start.s;
    bottom = top + 2 * (pi - theta);
  }
  top = std::max(top, 0.0);
  bottom = std::max(bottom, top);
  double rise_from = 0;
  double rise_from_distance = start.distance;
  double rise_velocity = start.velocity;
  std::int64_t passed = 0;
  // Where the velocity vanishes sin(s + h) is known, so the distance there needs no trigonometric function; but that
  // form cancels in short flights and under strong forces.
  const bool cancels = top < 0.5 || gamma_ > 30;
  const double reach = gamma_ * std::sqrt(one_minus_a * (2 - one_minus_a));
  const double middle = start.distance + flight.push;
  const auto top_at = [&](double h) { return cancels ? along(start, flight, h).distance : middle + drift * h + reach; };
  const auto bottom_at = [&](double h) {
    return cancels ? along(start, flight, h).distance : middle + drift * h - reach;
  };
  for (;;) {
    const double top_distance = top_at(top);
    if (top_distance >= 1) {
      const double rise = top_distance - rise_from_distance;
      const double guess = rise_from + (top - rise_from) * cubic_fraction((1 - rise_from_distance) / rise,
                                                                          rise_velocity * (top - rise_from) / rise);
      const Root root = monotone_root(start, flight, 1, rise_from, top, guess, true);
      flight.hits = flight.crosses = true;
      flight.duration = root.h;
      flight.speed = std::max(0.0, root.velocity);
      return flight;
    }
    const double bottom_distance = bottom_at(bottom);
    if (bottom_distance < 0) {
      const double guess = top + (bottom - top) * cubic_fraction(top_distance / (top_distance - bottom_distance), 0);
      const Root root = monotone_root(start, flight, 0, top, bottom, guess, false);
      flight.hits = true;
      flight.crosses = false;
      flight.duration = root.h;
      flight.speed = std::max(0.0, -root.velocity);
      return flight;
    }
    if (drift == 0) return flight;
    // No contact in this period: later ones are shifted by the drift, so those out of reach are skipped.
    const double room = drift > 0 ? 1 - top_distance : bottom_distance;
    const double wait = std::floor(room / (2 * pi * std::abs(drift)));
    const double skip = std::max(1.0, wait - 1);
    if (!(static_cast<double>(passed) + skip <= static_cast<double>(max_free_periods))) return flight;
    passed += static_cast<std::int64_t>(skip);
    top += 2 * pi * skip;
    bottom += 2 * pi * skip;
    rise_from = bottom - 2 * pi;
    rise_velocity = 0;
    rise_from_distance = bottom_at(rise_from);
  }
}

GapState GapMotion::after_impact(const GapState& start, const Flight& flight) const noexcept {
  GapState state = start;
  advance_phase(state, flight.duration);
  if (flight.crosses) state.wall = 1 - state.wall;
  state.distance = 0;
  state.velocity = restitution_ * flight.speed;
  return state;
}

ChatterTail GapMotion::chatter_tail(const GapState& after_impact) const noexcept {
  ChatterTail tail;
  const double pressure = -after_impact.parity() * gamma_ * after_impact.sin_s;
  if (!(pressure > 0) || restitution_ >= 1) return tail;
  const double to_reversal = after_impact.s < 0 ? -after_impact.s : pi - after_impact.s;
  tail.duration = 2 * after_impact.velocity / (pressure * (1 - restitution_));
  // The pressure falls at most linearly to 0 at the reversal, so within a hundredth of the way there it is constant to
  // 1 %, and the geometric series of hops ends.
  if (!(tail.duration <= 0.01 * to_reversal)) return tail;
  tail.completes = true;
  const double e3 = restitution_ * restitution_ * restitution_;
  tail.area = 2.0 / 3.0 * after_impact.velocity * after_impact.velocity * after_impact.velocity /
              (pressure * pressure * (1 - e3));
  // Relative change of the pressure, cot s per radian, and turn of e^{-j k tau}, k <= 5, over the tail.
  tail.area_error = tail.area * tail.duration * (5 + 4 * std::abs(after_impact.cos_s / after_impact.sin_s));
  // Work of the force over the tail: int a dd = -int a' d, the rate of the acceleration a being parity gamma cos s.
  tail.loss = 0.5 * after_impact.velocity * after_impact.velocity -
              after_impact.parity() * gamma_ * after_impact.cos_s * tail.area;
  return tail;
}

}  // namespace backlash::detail
