// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_segment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

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

// An equation in the unknowns of the first impact, of one impact and the next one, and in the parameter.
struct Row {
  std::array<double, 2> first{}, here{}, next{};
  double parameter = 0;
  double right = 0;

  void subtract(double factor, const Row& other) noexcept {
    for (std::size_t i = 0; i < 2; ++i) {
      first[i] -= factor * other.first[i];
      here[i] -= factor * other.here[i];
      next[i] -= factor * other.next[i];
    }
    parameter -= factor * other.parameter;
    right -= factor * other.right;
  }
};

// The linearised equations of the flights of an orbit, bordered by a last one.
class BorderedSystem {
 public:
  BorderedSystem(const OrbitSegment& orbit, const Direction& border) : border_(border) {
    const double gamma = orbit.gamma();
    const bool by_gamma = orbit.along == BranchParameter::log_gamma;
    rows_.reserve(2 * orbit.impacts.size());
    for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
      const SegmentImpact from = orbit.impact(i);
      const SegmentImpact to = orbit.impact(i + 1);
      const FlightEquations e = equations(gamma, orbit.restitution, from, to);
      rows_.push_back({{},
                       {e.place_phase0, e.place_speed0},
                       {e.place_phase1, 0},
                       by_gamma ? e.place_log_gamma : e.place_restitution,
                       -e.place});
      rows_.push_back({{},
                       {e.velocity_phase0, e.velocity_speed0},
                       {e.velocity_phase1, e.velocity_speed1},
                       by_gamma ? e.velocity_log_gamma : e.velocity_restitution,
                       -e.velocity});
      residual_ = std::max({residual_, std::abs(e.place), std::abs(e.velocity)});
      scale_ = std::max(scale_, (gamma + std::abs(from.speed)) * std::max(1.0, to.phase - from.phase));
    }
  }

  [[nodiscard]] double residual() const noexcept { return residual_; }
  /// Size of the terms that the residuals are sums of.
  [[nodiscard]] double scale() const noexcept { return scale_; }
  /// Newton's step, with which the border becomes `border_right`.
  [[nodiscard]] Direction step(double border_right) const { return solved(1, border_right); }
  /// The solution without residuals.
  [[nodiscard]] Direction tangent() const { return solved(0, 1); }

 private:
  // Gaussian elimination of one impact after the other, from the second one on, with the pivots of its two unknowns
  // among the four equations that hold them.  What is left of these goes on to the next impact, and in the end three
  // equations in the unknowns of the first impact and the parameter are left.
  [[nodiscard]] Direction solved(double residuals, double border_right) const {
    const std::size_t n = rows_.size() / 2;
    const auto flight = [&](std::size_t i, std::size_t which) {
      Row row = rows_[2 * i + which];
      row.right *= residuals;
      return row;
    };
    // The last flight ends at the first impact.
    const auto close = [](Row& row) {
      row.first = {row.first[0] + row.next[0], row.first[1] + row.next[1]};
      row.next = {};
    };
    // Equations 0 and 1 are left of the flights before, 2 and 3 are those of the next flight, 4 is the border.
    std::array<Row, 5> at{};
    for (std::size_t which = 0; which < 2; ++which) {
      at[which] = flight(0, which);
      at[which].first = at[which].here;
      at[which].here = {};
      if (n == 1) close(at[which]);
    }
    at[4].first = {border_[0], border_[1]};
    at[4].parameter = border_.back();
    at[4].right = border_right;
    std::vector<Row> pivots;
    pivots.reserve(2 * n);
    for (std::size_t k = 1; k < n; ++k) {
      for (std::size_t i = 0; i < 2; ++i) at[i].here = std::exchange(at[i].next, {});
      for (std::size_t which = 0; which < 2; ++which) {
        at[2 + which] = flight(k, which);
        if (k + 1 == n) close(at[2 + which]);
      }
      // Eliminations before this one have filled in what the border holds of this impact.
      at[4].here = {border_[2 * k] + at[4].next[0], border_[2 * k + 1] + at[4].next[1]};
      at[4].next = {};
      for (std::size_t column = 0; column < 2; ++column) {
        const auto remaining = at.begin() + static_cast<std::ptrdiff_t>(column);
        std::iter_swap(remaining, std::max_element(remaining, at.end() - 1, [&](const Row& a, const Row& b) {
                         return std::abs(a.here[column]) < std::abs(b.here[column]);
                       }));
        const Row& pivot = *remaining;
        for (std::size_t i = column + 1; i < at.size(); ++i)
          at[i].subtract(at[i].here[column] / pivot.here[column], pivot);
        pivots.push_back(pivot);
      }
      at[0] = at[2];
      at[1] = at[3];
    }

    Direction solution(2 * n + 1);
    const auto [phase, speed, parameter] = last_unknowns({at[0], at[1], at[4]});
    solution[0] = phase;
    solution[1] = speed;
    solution.back() = parameter;
    for (std::size_t k = n - 1; k > 0; --k) {
      for (std::size_t column = 2; column-- > 0;) {
        const Row& row = pivots[2 * (k - 1) + column];
        double right = row.right - row.first[0] * phase - row.first[1] * speed - row.parameter * parameter;
        if (k + 1 < n) right -= row.next[0] * solution[2 * k + 2] + row.next[1] * solution[2 * k + 3];
        if (column == 0) right -= row.here[1] * solution[2 * k + 1];
        solution[2 * k + column] = right / row.here[column];
      }
    }
    return solution;
  }

  static std::array<double, 3> last_unknowns(const std::array<Row, 3>& rows) {
    std::array<std::array<double, 4>, 3> m{};
    for (std::size_t i = 0; i < 3; ++i) m[i] = {rows[i].first[0], rows[i].first[1], rows[i].parameter, rows[i].right};
    for (std::size_t column = 0; column < 3; ++column) {
      const auto remaining = m.begin() + static_cast<std::ptrdiff_t>(column);
      std::iter_swap(remaining, std::max_element(remaining, m.end(), [&](const auto& a, const auto& b) {
                       return std::abs(a[column]) < std::abs(b[column]);
                     }));
      for (std::size_t i = column + 1; i < 3; ++i) {
        const double factor = m[i][column] / m[column][column];
        for (std::size_t j = column; j < 4; ++j) m[i][j] -= factor * m[column][j];
      }
    }
    std::array<double, 3> x{};
    for (std::size_t i = 3; i-- > 0;) {
      x[i] = m[i][3];
      for (std::size_t j = i + 1; j < 3; ++j) x[i] -= m[i][j] * x[j];
      x[i] /= m[i][i];
    }
    return x;
  }

  const Direction& border_;
  std::vector<Row> rows_;
  double residual_ = 0;
  double scale_ = 1;
};

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
    const BorderedSystem system(orbit, normal);
    const Direction step = system.step(-dot(normal, difference(orbit, guess)));
    double size = 0;
    for (const double value : step) {
      // Where the system is singular the step is not a number.
      size = std::isnan(value) ? std::numeric_limits<double>::infinity() : std::max(size, std::abs(value));
    }
    if (!(size < 0.5)) return std::nullopt;
    const OrbitSegment next = moved(orbit, step, 1);
    if (!phases_rise(next)) return std::nullopt;
    orbit = next;
    // Quadratic convergence: the step after this one is lost in rounding.
    if (size <= 1e-9 * std::min(1.0, 1 / system.scale())) return orbit;
    // Near a singular point Newton stalls at rounding times the condition of the system.
    if (size > 0.5 * last_step && size < 1e-7) {
      return system.residual() <= 64 * rounding * system.scale() ? std::optional(orbit) : std::nullopt;
    }
    last_step = size;
  }
  return std::nullopt;
}

std::optional<Direction> tangent(const OrbitSegment& orbit, const Direction& along) {
  Direction solution = BorderedSystem(orbit, along).tangent();
  const double norm = std::sqrt(dot(solution, solution));
  if (!std::isfinite(norm) || !(norm > 0)) return std::nullopt;
  for (double& value : solution) value /= norm;
  return solution;
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

std::optional<OrbitSegment> repeated_round(const OrbitSegment& orbit) {
  const auto impacts = static_cast<int>(orbit.impacts.size());
  for (int rounds = std::gcd(impacts, orbit.half_periods); rounds > 1; --rounds) {
    if (impacts % rounds != 0 || orbit.half_periods % rounds != 0) continue;
    OrbitSegment round = orbit;
    round.half_periods /= rounds;
    round.impacts.resize(orbit.impacts.size() / static_cast<std::size_t>(rounds));
    double squares = 0;
    for (std::size_t i = 0; i < orbit.impacts.size(); ++i) {
      const SegmentImpact& first = round.impacts[i % round.impacts.size()];
      const auto turn = static_cast<int>(i / round.impacts.size());
      const SegmentImpact& again = orbit.impacts[i];
      const int wall = round.symmetric() && turn % 2 != 0 ? 1 - first.wall : first.wall;
      const double phase = again.phase - first.phase - turn * round.half_periods * pi;
      const double speed = again.speed - first.speed;
      squares += wall == again.wall ? phase * phase + speed * speed : 1;
    }
    if (squares < 1e-12) return round;
  }
  return std::nullopt;
}

std::optional<OrbitSegment> corrected_to_shortest(const OrbitSegment& guess) {
  const std::optional<OrbitSegment> found = corrected(with_reduced_phase(guess), parameter_direction(guess));
  if (!found) return std::nullopt;
  const std::optional<OrbitSegment> round = repeated_round(*found);
  return round ? corrected(*round, parameter_direction(*round)) : found;
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
