// SPDX-License-Identifier: BSD-3-Clause
#include "orbit_correction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "flight_equations.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double rounding = std::numeric_limits<double>::epsilon();

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
      const FlightEquations e = flight_equations(gamma, orbit.restitution, from, to);
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

}  // namespace

std::optional<OrbitSegment> corrected(const OrbitSegment& guess, const Direction& normal) {
  OrbitSegment orbit = guess;
  double last_step = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < 12; ++iteration) {
    const BorderedSystem system(orbit, normal);
    const Direction step = system.step(-dot(normal, difference(orbit, guess)));
    double size = 0;
    for (const double value : step) {
      // The step is not a number where the system is singular.
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
