// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_segment.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

double side_of(int wall) noexcept {
  return wall == 0 ? 1 : -1;
}

// One flight in the unknowns of its two ends.
struct FlightEquations {
  double place, velocity;                           // residuals
  double place_phase0, place_speed0, place_phase1;  // derivatives; place does not depend on speed1
  double velocity_phase0, velocity_speed0, velocity_phase1, velocity_speed1;
  double place_log_gamma, velocity_log_gamma, place_restitution, velocity_restitution;
};

FlightEquations equations(double gamma, double restitution, const SegmentImpact& from, const SegmentImpact& to) {
  const double h = to.phase - from.phase;
  const double sin0 = std::sin(from.phase);
  const double cos0 = std::cos(from.phase);
  const double side0 = side_of(from.wall);
  const double side1 = side_of(to.wall);
  const double start = side0 * restitution * from.speed;
  const double half_sin = std::sin(0.5 * h);
  const double one_minus_cos = 2 * half_sin * half_sin;
  const double sin_h = std::sin(h);
  const double pushed = gamma * (cos0 * one_minus_cos - sin0 * (h - sin_h));
  const double gained = gamma * (cos0 * sin_h - sin0 * one_minus_cos);
  FlightEquations e{};
  e.place = (from.wall - to.wall) + start * h + pushed;
  e.velocity = start + gained + side1 * to.speed;
  e.place_phase0 = -start - gamma * cos0 * h;
  e.place_speed0 = side0 * restitution * h;
  e.place_phase1 = start + gained;
  e.velocity_phase0 = -gamma * cos0;
  e.velocity_speed0 = side0 * restitution;
  e.velocity_phase1 = gamma * std::cos(to.phase);
  e.velocity_speed1 = side1;
  e.place_log_gamma = pushed;
  e.velocity_log_gamma = gained;
  e.place_restitution = side0 * from.speed * h;
  e.velocity_restitution = side0 * from.speed;
  return e;
}

Eigen::Index index_of(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

// Residuals and their Jacobian, bordered by a last row.
struct System {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd residual;
  double scale;  // size of the terms that the residuals are sums of
};

System bordered(const OrbitSegment& orbit, const Direction& border) {
  const std::size_t n = orbit.impacts.size();
  const Eigen::Index size = index_of(2 * n + 1);
  System system{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size), 1};
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < n; ++i) {
    const SegmentImpact from = orbit.impact(i);
    const SegmentImpact to = orbit.impact(i + 1);
    const FlightEquations e = equations(gamma, orbit.restitution, from, to);
    const Eigen::Index row = index_of(2 * i);
    const Eigen::Index first = row;
    const Eigen::Index next = index_of(2 * ((i + 1) % n));
    // An orbit of one impact meets itself: derivatives add.
    system.matrix(row, first) += e.place_phase0;
    system.matrix(row, first + 1) += e.place_speed0;
    system.matrix(row, next) += e.place_phase1;
    const bool by_gamma = orbit.along == BranchParameter::log_gamma;
    system.matrix(row, size - 1) = by_gamma ? e.place_log_gamma : e.place_restitution;
    system.matrix(row + 1, first) += e.velocity_phase0;
    system.matrix(row + 1, first + 1) += e.velocity_speed0;
    system.matrix(row + 1, next) += e.velocity_phase1;
    system.matrix(row + 1, next + 1) += e.velocity_speed1;
    system.matrix(row + 1, size - 1) = by_gamma ? e.velocity_log_gamma : e.velocity_restitution;
    system.residual(row) = e.place;
    system.residual(row + 1) = e.velocity;
    system.scale = std::max(system.scale, (gamma + std::abs(from.speed)) * std::max(1.0, to.phase - from.phase));
  }
  for (Eigen::Index j = 0; j < size; ++j) system.matrix(size - 1, j) = border[static_cast<std::size_t>(j)];
  return system;
}

OrbitSegment moved_by(const OrbitSegment& from, const Eigen::VectorXd& step) {
  OrbitSegment result = from;
  for (std::size_t i = 0; i < from.impacts.size(); ++i) {
    result.impacts[i].phase += step(index_of(2 * i));
    result.impacts[i].speed += step(index_of(2 * i + 1));
  }
  result.set_parameter(from.parameter() + step(step.size() - 1));
  return result;
}

bool phases_rise(const OrbitSegment& orbit) {
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    if (!(orbit.impact(i + 1).phase > orbit.impacts[i].phase)) return false;
  }
  return true;
}

OrbitSegment with_reduced_phase(OrbitSegment orbit) {
  const double turns = std::floor(orbit.impacts.front().phase / (2 * pi));
  if (turns != 0) {
    for (SegmentImpact& impact : orbit.impacts) impact.phase -= 2 * pi * turns;
  }
  return orbit;
}

}  // namespace

double OrbitSegment::gamma() const noexcept {
  return std::exp(log_gamma);
}

SegmentImpact OrbitSegment::impact(std::size_t i) const noexcept {
  if (i < impacts.size()) return impacts[i];
  SegmentImpact again = impacts[i - impacts.size()];
  again.phase += half_periods * pi;
  if (symmetric()) again.wall = 1 - again.wall;
  return again;
}

Direction parameter_direction(const OrbitSegment& segment) {
  Direction direction(2 * segment.impacts.size() + 1, 0.0);
  direction.back() = 1;
  return direction;
}

Direction difference(const OrbitSegment& to, const OrbitSegment& from) {
  Direction result;
  result.reserve(2 * to.impacts.size() + 1);
  for (std::size_t i = 0; i < to.impacts.size(); ++i) {
    result.push_back(to.impacts[i].phase - from.impacts[i].phase);
    result.push_back(to.impacts[i].speed - from.impacts[i].speed);
  }
  result.push_back(to.parameter() - from.parameter());
  return result;
}

OrbitSegment moved(const OrbitSegment& from, const Direction& direction, double length) {
  OrbitSegment result = from;
  for (std::size_t i = 0; i < from.impacts.size(); ++i) {
    result.impacts[i].phase += length * direction[2 * i];
    result.impacts[i].speed += length * direction[2 * i + 1];
  }
  result.set_parameter(from.parameter() + length * direction.back());
  return result;
}

double dot(const Direction& a, const Direction& b) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::optional<OrbitSegment> corrected(const OrbitSegment& guess, const Direction& normal) {
  OrbitSegment orbit = guess;
  double last_step = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 12; ++iteration) {
    System system = bordered(orbit, normal);
    system.residual(system.residual.size() - 1) = dot(normal, difference(orbit, guess));
    const Eigen::VectorXd step = system.matrix.partialPivLu().solve(-system.residual);
    const double size = step.lpNorm<Eigen::Infinity>();
    if (!(size < 0.5)) return std::nullopt;
    const OrbitSegment next = moved_by(orbit, step);
    if (!phases_rise(next)) return std::nullopt;
    orbit = next;
    // Quadratic convergence: the step after this one is lost in rounding.
    if (size <= 1e-9 * std::min(1.0, 1 / system.scale)) return orbit;
    // Near a singular point Newton stalls at rounding times the condition of the system.
    if (size > 0.5 * last_step && size < 1e-7) {
      return system.residual.lpNorm<Eigen::Infinity>() <= 64 * rounding * system.scale ? std::optional(orbit)
                                                                                       : std::nullopt;
    }
    last_step = size;
  }
  return std::nullopt;
}

std::optional<Direction> tangent(const OrbitSegment& orbit, const Direction& along) {
  const System system = bordered(orbit, along);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(system.residual.size());
  right(right.size() - 1) = 1;
  Eigen::VectorXd solution = system.matrix.partialPivLu().solve(right);
  const double norm = solution.norm();
  if (!std::isfinite(norm) || !(norm > 0)) return std::nullopt;
  solution /= norm;
  return Direction(solution.data(), solution.data() + solution.size());
}

bool ScaledReturnMap::stable() const noexcept {
  return scale > 0 && std::abs(matrix[0] + matrix[3]) <= scale * (1 + determinant);
}

ScaledReturnMap return_map(const OrbitSegment& orbit) {
  ScaledReturnMap map{{1, 0, 0, 1}, 1, std::pow(orbit.restitution, 2.0 * static_cast<double>(orbit.impacts.size()))};
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    const SegmentImpact to = orbit.impact(i + 1);
    const FlightEquations e = equations(gamma, orbit.restitution, orbit.impact(i), to);
    // place_phase1 dphase1 = -(place_phase0 dphase0 + place_speed0 dspeed0), and place_phase1 = -side1 speed1.
    const double side = e.velocity_speed1;
    const double phase_phase = side * e.place_phase0;
    const double phase_speed = side * e.place_speed0;
    const double speed_phase = -side * (to.speed * e.velocity_phase0 + e.velocity_phase1 * phase_phase);
    const double speed_speed = -side * (to.speed * e.velocity_speed0 + e.velocity_phase1 * phase_speed);
    const std::array<double, 4> m = map.matrix;
    map.matrix = {phase_phase * m[0] + phase_speed * m[2], phase_phase * m[1] + phase_speed * m[3],
                  speed_phase * m[0] + speed_speed * m[2], speed_phase * m[1] + speed_speed * m[3]};
    map.scale *= to.speed;
  }
  return map;
}

std::array<std::complex<double>, 2> multipliers(const OrbitSegment& orbit) {
  const ScaledReturnMap map = return_map(orbit);
  const double half_trace = 0.5 * map.trace();
  const double discriminant = half_trace * half_trace - map.determinant;
  std::array<std::complex<double>, 2> result;
  if (discriminant < 0) {
    const double imaginary = std::sqrt(-discriminant);
    result = {std::complex<double>(half_trace, imaginary), std::complex<double>(half_trace, -imaginary)};
  } else {
    // The smaller one from the determinant, free of cancellation.
    const double larger = half_trace + std::copysign(std::sqrt(discriminant), half_trace);
    result = {larger, larger == 0 ? 0.0 : map.determinant / larger};
  }
  if (orbit.symmetric()) {
    // Real ones apart: the complex square of an infinite one has no phase.
    for (std::complex<double>& value : result) {
      value = value.imag() == 0 ? std::complex<double>(value.real() * value.real()) : value * value;
    }
  }
  return result;
}

ContactMargin contact_margin(const OrbitSegment& orbit) {
  ContactMargin least{std::numeric_limits<double>::infinity(), true, 0, {}};
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    const SegmentImpact from = orbit.impact(i);
    const SegmentImpact to = orbit.impact(i + 1);
    if (from.speed < least.margin) least = {from.speed, true, i, {}};
    const double start = side_of(from.wall) * orbit.restitution * from.speed;
    const double sin0 = std::sin(from.phase);
    const double cos0 = std::cos(from.phase);
    // The velocity start + gamma (sin tau - sin tau_0) vanishes where sin tau has this value.
    const double sine = sin0 - start / gamma;
    if (std::abs(sine) > 1) continue;
    const double first = std::asin(sine);
    for (const bool rising : {true, false}) {
      // Acceleration gamma cos tau > 0: a lowest point, which meets the wall u = 0; else a highest one.
      const double root = rising ? first : pi - first;
      const double turns = std::ceil((from.phase - root) / (2 * pi));
      for (double tau = root + 2 * pi * turns; tau < to.phase; tau += 2 * pi) {
        const double h = tau - from.phase;
        // At restitution 0 the flight begins with velocity 0, which is no turning point.
        if (h <= 1e-7) continue;
        const double half_sin = std::sin(0.5 * h);
        const double u = from.wall + start * h + gamma * (cos0 * 2 * half_sin * half_sin - sin0 * (h - std::sin(h)));
        const double margin = rising ? u : 1 - u;
        if (margin < least.margin) least = {margin, false, i, {tau, 0, rising ? 0 : 1}};
      }
    }
  }
  return least;
}

std::complex<double> harmonic(const OrbitSegment& orbit, int k) {
  if (orbit.symmetric() && k % 2 == 0) return 0;
  // Two integrations by parts over the closed orbit leave the velocity jumps; a mirror half counts twice for odd k.
  std::complex<double> sum = 0;
  for (const SegmentImpact& impact : orbit.impacts) {
    sum += side_of(impact.wall) * (1 + orbit.restitution) * impact.speed * std::polar(1.0, -k * impact.phase);
  }
  const std::complex<double> jumps = sum * (-2 / (pi * orbit.half_periods * k * k));
  return k == 1 ? jumps - orbit.gamma() : jumps;
}

OrbitSegment mirror_image(const OrbitSegment& orbit) {
  OrbitSegment result = orbit;
  for (SegmentImpact& impact : result.impacts) {
    impact.phase += pi;
    impact.wall = 1 - impact.wall;
  }
  return with_reduced_phase(result);
}

OrbitSegment doubled(const OrbitSegment& orbit) {
  OrbitSegment result = orbit;
  const std::size_t n = orbit.impacts.size();
  for (std::size_t i = 0; i < n; ++i) result.impacts.push_back(orbit.impact(n + i));
  result.half_periods = 2 * orbit.half_periods;
  return result;
}

std::optional<Halves> halves(const OrbitSegment& orbit) {
  const std::size_t n = orbit.impacts.size();
  if (n % 2 != 0 || orbit.half_periods % 2 != 0) return std::nullopt;
  Halves result{{}, orbit};
  result.mean.half_periods = orbit.half_periods / 2;
  result.mean.impacts.resize(n / 2);
  for (std::size_t i = 0; i < n / 2; ++i) {
    SegmentImpact other = orbit.impacts[i + n / 2];
    other.phase -= result.mean.half_periods * pi;
    if (result.mean.symmetric()) other.wall = 1 - other.wall;
    const SegmentImpact& one = orbit.impacts[i];
    if (other.wall != one.wall) return std::nullopt;
    result.difference.push_back(one.phase - other.phase);
    result.difference.push_back(one.speed - other.speed);
    result.mean.impacts[i] = {0.5 * (one.phase + other.phase), 0.5 * (one.speed + other.speed), one.wall};
  }
  return result;
}

Direction flip_direction(const OrbitSegment& orbit) {
  const ScaledReturnMap map = return_map(orbit);
  // Null vector of matrix + scale: from the larger of its rows.
  const double a = map.matrix[0] + map.scale;
  const double b = map.matrix[1];
  const double c = map.matrix[2];
  const double d = map.matrix[3] + map.scale;
  double phase = std::hypot(a, b) >= std::hypot(c, d) ? -b : -d;
  double speed = std::hypot(a, b) >= std::hypot(c, d) ? a : c;
  Direction half;
  const double gamma = orbit.gamma();
  for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
    half.push_back(phase);
    half.push_back(speed);
    const SegmentImpact to = orbit.impact(i + 1);
    const FlightEquations e = equations(gamma, orbit.restitution, orbit.impact(i), to);
    const double next = -(e.place_phase0 * phase + e.place_speed0 * speed) / e.place_phase1;
    speed = -e.velocity_speed1 * (e.velocity_phase0 * phase + e.velocity_speed0 * speed + e.velocity_phase1 * next);
    phase = next;
  }
  Direction result = half;
  for (const double value : half) result.push_back(-value);
  result.push_back(0);
  const double norm = std::sqrt(dot(result, result));
  for (double& value : result) value /= norm;
  return result;
}

OrbitSegment with_impact(const OrbitSegment& orbit, std::size_t before, const SegmentImpact& impact) {
  OrbitSegment result = orbit;
  result.impacts.insert(result.impacts.begin() + static_cast<std::ptrdiff_t>(before) + 1, impact);
  return result;
}

OrbitSegment without_impact(const OrbitSegment& orbit, std::size_t index) {
  OrbitSegment result = orbit;
  result.impacts.erase(result.impacts.begin() + static_cast<std::ptrdiff_t>(index));
  return with_reduced_phase(result);
}

std::optional<OrbitSegment> corrected_to_shortest(const OrbitSegment& guess) {
  std::optional<OrbitSegment> found = corrected(with_reduced_phase(guess), parameter_direction(guess));
  while (found) {
    const std::optional<Halves> parts = halves(*found);
    if (!parts || !(std::sqrt(dot(parts->difference, parts->difference)) < 1e-6)) return found;
    found = corrected(parts->mean, parameter_direction(parts->mean));
  }
  return std::nullopt;
}

std::optional<OrbitSegment> orbit_through(const GapMotion& motion, const GapState& on_orbit, int impacts,
                                          int half_periods) {
  OrbitSegment orbit{std::log(motion.gamma()), motion.restitution(), half_periods, {}};
  GapState state = on_orbit;
  for (int i = 0; i < impacts; ++i) {
    if (motion.rests(state)) return std::nullopt;
    const Flight flight = motion.next_flight(state);
    if (!flight.hits) return std::nullopt;
    state = motion.after_impact(state, flight);
    orbit.impacts.push_back({static_cast<double>(state.half_period) * pi - pi / 2 + state.s, flight.speed, state.wall});
  }
  return corrected_to_shortest(orbit);
}

}  // namespace backlash::detail
