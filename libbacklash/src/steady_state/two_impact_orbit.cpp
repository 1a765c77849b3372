// SPDX-License-Identifier: BSD-3-Clause
#include "two_impact_orbit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

// Post-impact state at the wall u = 0 at the phase tau with the given sine and cosine.
GapState state_at_wall(double sin_tau, double cos_tau, double velocity) {
  GapState state;
  // tau = K pi - pi/2 + s with cos s >= 0.
  if (sin_tau <= 0) {
    state.half_period = 0;
    state.s = std::atan2(cos_tau, -sin_tau);
  } else {
    state.half_period = 1;
    state.s = std::atan2(-cos_tau, sin_tau);
  }
  advance_phase(state, 0);
  state.velocity = velocity;
  return state;
}

// Bisection for the point in [inside, outside] where `holds` turns false, to the last bit.
template <typename Predicate>
double boundary(double inside, double outside, const Predicate& holds) {
  for (;;) {
    const double middle = 0.5 * (inside + outside);
    if (middle == inside || middle == outside) return inside;
    (holds(middle) ? inside : outside) = middle;
  }
}

// Members of a family looked at for its first change of stability.
constexpr int scan_steps = 400;

}  // namespace

double saddle_node_gamma(double restitution) {
  const double lost = 1 - restitution;
  const double kept = 1 + restitution;
  return lost / (2 * std::hypot(lost, 0.5 * pi * kept));
}

double symmetry_breaking_gamma(double restitution) {
  const double s = 2 * pi / (pi * pi - 4);
  return 0.5 * std::hypot(s * (1 - restitution) / (1 + restitution), 4 / (pi * pi - 4));
}

SymmetricFamily::SymmetricFamily(double restitution) noexcept
    : lost_(1 - restitution),
      kept_(1 + restitution),
      saddle_node_(saddle_node_gamma(restitution)),
      a_(lost_ * lost_ + 0.25 * pi * pi * kept_ * kept_),
      inverse_a_(1 / a_),
      half_b_(0.5 * pi * kept_) {}

SymmetricImpact SymmetricFamily::at(double gamma) const noexcept {
  // half_b^2 - a (1 - 4 gamma^2) without cancellation near the saddle-node, where it vanishes.
  const double root = std::sqrt(4 * a_ * (gamma - saddle_node_) * (gamma + saddle_node_));
  const double half_inverse = 0.5 / gamma;
  SymmetricImpact impact;
  impact.speed = (half_b_ + root) * inverse_a_;
  impact.sin_phase = -impact.speed * lost_ * half_inverse;
  impact.cos_phase = (1 - half_b_ * impact.speed) * half_inverse;
  // gamma and the saddle-node come of a few operations each, so their difference is known to 8 roundings of gamma and
  // the discriminant to 64 a gamma^2 of them, m^2 say.  Its root is then known to m^2 over the root, or to m where that
  // is less.  U_1 + gamma = -2 (1+e)/pi v e^{-j phi} changes with v by |1 - pi (1+e) v + 2 j (1-e) v|/(2 gamma) of
  // that.
  const double m = gamma * std::sqrt(64 * a_ * rounding);
  const double speed_error = m * m / std::max(root, m) * inverse_a_;
  const double by_speed = std::abs(1 - 2 * half_b_ * impact.speed) + 2 * lost_ * impact.speed;
  const double rounded = 8 * rounding * impact.speed * (1 + half_b_ * impact.speed);
  impact.uncertainty = 16 * rounding * (1 + gamma) + 2 / pi * kept_ * half_inverse * (by_speed * speed_error + rounded);
  return impact;
}

std::optional<TwoImpactOrbit> symmetric_two_impact_orbit(double gamma, double restitution) {
  const SymmetricFamily family(restitution);
  if (!(gamma >= family.saddle_node())) return std::nullopt;
  const SymmetricImpact impact = family.at(gamma);
  return TwoImpactOrbit{gamma, impact.speed,
                        state_at_wall(impact.sin_phase, impact.cos_phase, restitution * impact.speed), pi};
}

TwoImpactOrbit asymmetric_two_impact_orbit(double asymmetry, double restitution) {
  // With flight times pi -+ 2x, middle phase theta = (tau_0 + tau_1)/2 and impact speed v, the two flight equations are
  // linear in P = (1 + e) v/2 and Q = gamma sin theta:
  //   P = -(pi sin x/(2x)) Q,   1/Q = 2 cos x - (pi^2 - 4x^2) sin x/(2x),   gamma cos theta = (1 - e)/(1 + e) P/cos x.
  const double x = asymmetry;
  const double sin_ratio = x == 0 ? 1 : std::sin(x) / x;
  const double cos_x = std::cos(x);
  const double q = 1 / (2 * cos_x - 0.5 * (pi * pi - 4 * x * x) * sin_ratio);
  const double p = -0.5 * pi * sin_ratio * q;
  const double gamma_cos = (1 - restitution) / (1 + restitution) * p / cos_x;
  const double gamma = std::hypot(q, gamma_cos);
  const double sin_theta = q / gamma;
  const double cos_theta = gamma_cos / gamma;
  const double sin_x = std::sin(x);
  // tau_0 = theta - (pi/2 - x)
  const double sin_tau = sin_theta * sin_x - cos_theta * cos_x;
  const double cos_tau = cos_theta * sin_x + sin_theta * cos_x;
  const double speed = 2 * p / (1 + restitution);
  return {gamma, speed, state_at_wall(sin_tau, cos_tau, restitution * speed), pi - 2 * x};
}

bool TwoImpactOrbit::symmetric() const noexcept {
  return flight_time == pi;
}

bool TwoImpactStability::stable() const noexcept {
  return admissible && determinant <= 1 && std::abs(trace) <= 1 + determinant;
}

TwoImpactStability two_impact_stability(const TwoImpactOrbit& orbit, double restitution) {
  const GapMotion motion(orbit.gamma, restitution);
  TwoImpactStability result{false, std::numeric_limits<double>::quiet_NaN(), std::pow(restitution, 4)};
  GapState state = orbit.start;
  Jacobian jacobian;
  for (int i = 0; i < 2; ++i) {
    if (motion.rests(state)) return result;
    const Flight flight = motion.next_flight(state);
    const double expected = i == 0 ? orbit.flight_time : 2 * pi - orbit.flight_time;
    // An extra contact ends the flight early by far more than rounding.
    if (!flight.hits || !flight.crosses || std::abs(flight.duration - expected) > 1e-6) return result;
    const GapState next = motion.after_impact(state, flight);
    jacobian = chain(jacobian, motion, state, flight, next);
    state = next;
  }
  result.admissible = true;
  result.trace = jacobian.trace();
  return result;
}

std::optional<TwoImpactOrbit> stable_two_impact_orbit(double gamma, double restitution) {
  const bool needs_loss = restitution > 0 && gamma > symmetry_breaking_gamma(restitution);
  return stable_two_impact_orbit(gamma, restitution, needs_loss ? two_impact_loss(restitution).gamma : 0);
}

std::optional<TwoImpactOrbit> stable_two_impact_orbit(double gamma, double restitution, double loss_gamma) {
  const double breaking = symmetry_breaking_gamma(restitution);
  if (gamma <= breaking) {
    const std::optional<TwoImpactOrbit> orbit = symmetric_two_impact_orbit(gamma, restitution);
    if (!orbit || !two_impact_stability(*orbit, restitution).admissible) return std::nullopt;
    return orbit;
  }
  // gamma rises with the asymmetry up to the end of the stable family.
  if (restitution == 0 || gamma > loss_gamma) return std::nullopt;
  const double asymmetry =
      boundary(0.0, 0.5 * pi, [&](double x) { return asymmetric_two_impact_orbit(x, restitution).gamma <= gamma; });
  const TwoImpactOrbit orbit = asymmetric_two_impact_orbit(asymmetry, restitution);
  if (!two_impact_stability(orbit, restitution).stable()) return std::nullopt;
  return orbit;
}

Harmonics two_impact_harmonics(const TwoImpactOrbit& orbit, double restitution) {
  JumpSum jumps;
  jumps.add(orbit.start, orbit.speed);
  GapState other = orbit.start;
  advance_phase(other, orbit.flight_time);
  other.wall = 1;
  other.velocity = restitution * orbit.speed;
  jumps.add(other, orbit.speed);
  return harmonics_of_jumps(jumps, orbit.gamma, 2);
}

SymmetryLoss symmetry_loss(double restitution) {
  const double node = saddle_node_gamma(restitution);
  const double breaking = symmetry_breaking_gamma(restitution);
  const auto admissible = [&](double gamma) {
    const std::optional<TwoImpactOrbit> orbit = symmetric_two_impact_orbit(gamma, restitution);
    return orbit && two_impact_stability(*orbit, restitution).admissible;
  };
  double inside = 0;
  for (int i = 1; i <= scan_steps; ++i) {
    const double gamma = node + (breaking - node) * i / scan_steps;
    if (admissible(gamma)) {
      inside = gamma;
    } else if (inside > 0) {
      return {boundary(inside, gamma, admissible), true};
    }
  }
  return {breaking, false};
}

TwoImpactLoss two_impact_loss(double restitution) {
  const SymmetryLoss symmetric_end = symmetry_loss(restitution);
  if (symmetric_end.grazing) return {symmetric_end.gamma, TwoImpactEnd::grazing, true};
  const auto stable = [&](double x) {
    return two_impact_stability(asymmetric_two_impact_orbit(x, restitution), restitution).stable();
  };
  double inside = 0;
  for (int i = 1; i < scan_steps; ++i) {
    const double x = 0.5 * pi * i / scan_steps;
    if (stable(x)) {
      inside = x;
      continue;
    }
    const double last = boundary(inside, x, stable);
    const double first_lost = std::nextafter(last, pi);
    const TwoImpactOrbit lost = asymmetric_two_impact_orbit(first_lost, restitution);
    const TwoImpactStability stability = two_impact_stability(lost, restitution);
    const TwoImpactEnd end = !stability.admissible ? TwoImpactEnd::grazing
                             : stability.trace < 0 ? TwoImpactEnd::period_doubling
                                                   : TwoImpactEnd::fold;
    return {asymmetric_two_impact_orbit(last, restitution).gamma, end, false};
  }
  return {asymmetric_two_impact_orbit(inside, restitution).gamma, TwoImpactEnd::fold, false};
}

}  // namespace backlash::detail
