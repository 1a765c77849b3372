// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Multipliers smaller than e^-3 are not looked for.
constexpr double deepest = -3;
// Distance, in s tau, from the two points z = 1 and z = -1 at which the path begins and ends.
constexpr double near_point = 1e-3;

// D(z), without the root of a shift in time where there is one, as a function of s tau = ln(-z).
class Characteristic {
 public:
  /// Of a loop.
  Characteristic(const ImpulseTrain& train, double exchange)
      : train_(train),
        exchange_(exchange),
        acceleration_(train.sums({0, pi / train.half_period()})[2].real()),
        has_shift_(true) {}
  /// Under a force.
  Characteristic(const ImpulseTrain& train, double exchange, double acceleration)
      : train_(train), exchange_(exchange), acceleration_(acceleration), has_shift_(false) {}

  /// Poles of D with Re ln(-z) > edge, those at z = -1 left out: those of the flights between impacts.
  [[nodiscard]] int poles_beyond(double edge) const {
    const std::vector<double>& rates = train_.growth_rates();
    return static_cast<int>(std::count_if(rates.begin(), rates.end(), [&](double rate) { return rate > edge; }));
  }
  /// At which D changes its sign without a root.
  [[nodiscard]] bool is_pole(double log_z) const {
    const std::vector<double>& rates = train_.growth_rates();
    return std::any_of(rates.begin(), rates.end(),
                       [&](double rate) { return std::abs(rate - log_z) < 1e-9 * std::abs(log_z); });
  }
  /// Its value at infinity.
  [[nodiscard]] double scale() const noexcept { return exchange_ * exchange_; }

  Complex operator()(Complex log_z) const {
    const std::array<Complex, 3> g = train_.sums(log_z / train_.half_period());
    const Complex rate = exchange_ + g[1];
    const Complex inverse_z = -std::exp(-log_z);
    return (rate * rate - g[0] * (g[2] - acceleration_)) / (has_shift_ ? 1.0 - inverse_z : 1.0);
  }

 private:
  const ImpulseTrain& train_;
  double exchange_;
  double acceleration_;
  bool has_shift_;
};

// Change of the argument along a straight line; NaN where it runs into a root.
double turn(const Characteristic& d, Complex from, Complex to, Complex at_from, Complex at_to, int depth) {
  const Complex middle = 0.5 * (from + to);
  const Complex at_middle = d(middle);
  const double whole = std::arg(at_to / at_from);
  const double first = std::arg(at_middle / at_from);
  const double second = std::arg(at_to / at_middle);
  // A smooth function turns evenly, and its middle is not far from the mean of its ends.
  if (std::abs(first) < 1 && std::abs(second) < 1 && std::abs(first + second - whole) < 1e-6 &&
      std::abs(first - second) < 0.7) {
    return whole;
  }
  if (depth == 0 || !std::isfinite(first + second)) return std::numeric_limits<double>::quiet_NaN();
  return turn(d, from, middle, at_from, at_middle, depth - 1) + turn(d, middle, to, at_middle, at_to, depth - 1);
}

// Roots with Re ln(-z) > edge.  D is real on both lines Im ln(-z) = 0 and pi to the right of the singular point, and
// constant far right: the upper half of the left edge decides.  Left of the singular point the path goes back to it
// along the upper side of the cut.  Negative where the path meets a root.
int roots_beyond(const Characteristic& d, double edge) {
  std::vector<Complex> path{{edge, pi - near_point}};
  for (const double height : {2.4, 1.6, 0.9, 0.4, 0.15, 0.05, 0.015, 0.004}) path.emplace_back(edge, height);
  path.emplace_back(edge, near_point);
  if (edge < 0) {
    for (double x = edge / 3; x < -near_point; x /= 3) path.emplace_back(x, near_point);
  }
  if (edge <= 0) {
    for (const double angle : {0.5, 0.25, 0.0}) path.push_back(std::polar(near_point, angle * pi));
  } else {
    path.emplace_back(edge, 0);
  }
  double total = 0;
  Complex before = d(path.front());
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Complex after = d(path[i]);
    total += turn(d, path[i - 1], path[i], before, after, 16);
    before = after;
  }
  if (!std::isfinite(total)) return -1;
  return static_cast<int>(std::lround(total / pi)) + d.poles_beyond(edge);
}

// Muller's iteration from three points about the start; NaN where it leaves the strip or does not settle at a root.
Complex root_near(const Characteristic& d, Complex start) {
  const double step = 0.1 * std::min(0.5, std::abs(start));
  std::array<Complex, 3> x{start - step, start + step, start};
  std::array<Complex, 3> f{d(x[0]), d(x[1]), d(x[2])};
  const Complex none(std::numeric_limits<double>::quiet_NaN(), 0);
  for (int i = 0; i < 25; ++i) {
    const Complex slope = (f[2] - f[1]) / (x[2] - x[1]);
    const Complex before = (f[1] - f[0]) / (x[1] - x[0]);
    const Complex curvature = (slope - before) / (x[2] - x[0]);
    const Complex b = slope + curvature * (x[2] - x[1]);
    const Complex root = std::sqrt(b * b - 4.0 * f[2] * curvature);
    const Complex divisor = std::abs(b + root) > std::abs(b - root) ? b + root : b - root;
    Complex change = -2.0 * f[2] / divisor;
    if (std::abs(change) > 1) change /= std::abs(change);
    const Complex next = x[2] + change;
    // D takes conjugate values at conjugate points, and repeats after 2 pi; left of the singular point it has a cut.
    const bool crosses_cut = next.real() < 0 && next.imag() < 0;
    if (!(next.real() > deepest - 1 && next.real() < 40 && next.imag() > -1 && next.imag() < pi + 1) || crosses_cut) {
      return none;
    }
    const Complex value = d(next);
    if (std::abs(change) < 1e-10 && std::abs(value) < 1e-6 * d.scale()) {
      const double height = next.imag() > pi ? 2 * pi - next.imag() : std::abs(next.imag());
      return next.real() < 0 && height < 1e-6 ? none : Complex(next.real(), height);
    }
    x = {x[1], x[2], next};
    f = {f[1], f[2], value};
    if (x[2] == x[1] || x[1] == x[0] || x[2] == x[0]) return none;
  }
  return none;
}

// The root furthest right of those found from points on vertical lines between the two edges and, where the lines are
// several, on half circles about the singular point.
Complex furthest_root(const Characteristic& d, double left, double right, int columns, int points) {
  Complex best(-std::numeric_limits<double>::infinity(), 0);
  const auto start_at = [&](Complex start) {
    const Complex root = root_near(d, start);
    if (root.real() > best.real()) best = root;
  };
  for (int column = 0; column < columns; ++column) {
    const double x = right + (left - right) * column / columns;
    for (int i = 0; i < points; ++i) start_at({x, pi * (i + 0.5) / points});
  }
  for (double radius = 1; columns > 1 && radius > 2 * near_point; radius /= 3) {
    for (int i = 0; i < points; ++i) start_at(std::polar(radius, pi * (i + 0.5) / points));
  }
  return best;
}

// D is real on the line Im ln(-z) = pi, on the axis Im ln(-z) = 0 right of the singular point and, without fractional
// powers, left of it too: its roots there, furthest right first.  NaN where there is none.
double furthest_real_root(const Characteristic& d, double height, double from, double to) {
  const auto value = [&](double x) { return d({x, height}).real(); };
  constexpr int points = 60;
  double right = to;
  double at_right = value(right);
  for (int i = 1; i <= points; ++i) {
    const double left = to * std::pow(from / to, static_cast<double>(i) / points);
    const double at_left = value(left);
    if ((at_left > 0) != (at_right > 0)) {
      double low = left, high = right;
      for (int k = 0; k < 60 && low != high; ++k) {
        const double middle = 0.5 * (low + high);
        ((value(middle) > 0) == (at_right > 0) ? high : low) = middle;
      }
      if (!d.is_pole(low)) return low;
    }
    right = left;
    at_right = at_left;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

CycleStability stability_by(const Characteristic& d, bool has_whole_powers) {
  // A root is the furthest when none lies beyond a line next to it.
  const auto is_furthest = [&](Complex root) {
    return std::isfinite(root.real()) && roots_beyond(d, root.real() + 1e-3) == 0;
  };
  Complex log_z = furthest_root(d, 0, 0, 1, 4);
  bool known = is_furthest(log_z);
  if (!known) {
    // From further left, which finds most of those that the first line leads past.
    const Complex other = furthest_root(d, 0, -0.3, 1, 6);
    if (other.real() > log_z.real()) log_z = other;
    known = is_furthest(log_z);
  }
  CycleStability result{false, known && log_z.real() < -1e-3 ? 0 : roots_beyond(d, 0), 0, StabilityLoss::none};
  for (int effort = 1; effort <= 3 && !known; ++effort) {
    const bool is_unstable = result.unstable_multipliers != 0;
    log_z = furthest_root(d, is_unstable ? 0 : deepest, is_unstable ? 4 : 0, 6 * effort, 6 * effort);
    const auto consider = [&](double real, double height) {
      if (real > log_z.real()) log_z = {real, height};
    };
    if (is_unstable) {
      consider(furthest_real_root(d, 0, near_point, 40), 0);
      consider(furthest_real_root(d, pi, near_point, 40), pi);
    } else {
      consider(furthest_real_root(d, pi, deepest, -near_point), pi);
    }
    known = is_furthest(log_z);
  }
  if (has_whole_powers && log_z.real() < -near_point) {
    // The path of the count passes above the axis: its roots are looked for apart.
    const double real = furthest_real_root(d, 0, std::max(deepest, log_z.real()), -near_point);
    if (real > log_z.real()) log_z = real;
  }
  if (std::isfinite(log_z.real())) {
    result.dominant = -std::exp(log_z);
    if (std::abs(log_z.imag()) < 1e-9 || pi - log_z.imag() < 1e-9) result.dominant = result.dominant.real();
  }
  // A root on the path is one on the circle: neither stable nor counted.
  result.stable = result.unstable_multipliers == 0;
  if (result.unstable_multipliers != 0) {
    result.loss = result.dominant.imag() != 0  ? StabilityLoss::torus
                  : result.dominant.real() < 0 ? StabilityLoss::symmetry_breaking
                                               : StabilityLoss::saddle_node;
  }
  return result;
}

}  // namespace

CycleStability cycle_stability(const ImpulseTrain& train, double exchange) {
  return stability_by(Characteristic(train, exchange), train.has_whole_powers());
}

CycleStability forced_stability(const ImpulseTrain& train, double exchange, double acceleration) {
  return stability_by(Characteristic(train, exchange, acceleration), train.has_whole_powers());
}

}  // namespace backlash::detail
