// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "complex_quotient.hpp"
#include "dense_elimination.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
// Multipliers smaller than e^-3 are not looked for.
constexpr double deepest = -3;
// Distance, in s tau, from the two points z = 1 and z = -1 at which the path begins and ends.
constexpr double near_point = 1e-3;

// D as a function of ln z less the singular point z_0 of its sums: the shift in time, a root of every free motion, is
// divided out.
class Characteristic {
 public:
  explicit Characteristic(const ImpulseTrain& train) : train_(train) {}
  virtual ~Characteristic() = default;
  Characteristic(const Characteristic&) = delete;
  Characteristic& operator=(const Characteristic&) = delete;

  virtual Complex operator()(Complex log_z) const = 0;
  /// Its size at infinity.
  [[nodiscard]] virtual double scale() const = 0;
  /// z at that point.
  [[nodiscard]] virtual Complex multiplier(Complex log_z) const = 0;

  /// Poles of D with Re ln(z/z_0) > edge, those at z_0 left out: those of the flights between impacts.
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
  [[nodiscard]] bool has_whole_powers() const { return train_.has_whole_powers(); }
  /// Its sums have no singular point but that at z_0.
  [[nodiscard]] bool is_smooth() const { return train_.is_sum_of_powers(); }

 protected:
  const ImpulseTrain& train_;
};

// Per half period of a symmetric motion; z_0 = -1.
class HalfPeriod final : public Characteristic {
 public:
  /// Half a period of a cycle of a loop.
  HalfPeriod(const ImpulseTrain& train, double exchange)
      : Characteristic(train),
        exchange_(exchange),
        acceleration_(train.sums({0, pi / train.half_period()})[2].real()),
        has_shift_(true) {}
  /// Under a force.
  HalfPeriod(const ImpulseTrain& train, double exchange, double acceleration)
      : Characteristic(train), exchange_(exchange), acceleration_(acceleration), has_shift_(false) {}

  [[nodiscard]] double scale() const override { return exchange_ * exchange_; }
  [[nodiscard]] Complex multiplier(Complex log_z) const override { return -std::exp(log_z); }

  Complex operator()(Complex log_z) const override {
    const TrainPoint point(-log_z);
    const std::array<Complex, 3> g = train_.sums(point);
    const Complex rate = exchange_ + g[1];
    const Complex value = rate * rate - g[0] * (g[2] - acceleration_);
    return has_shift_ ? quotient(value, 1.0 + point.turned) : value;
  }

 private:
  double exchange_;
  double acceleration_;
  bool has_shift_;
};

// Per period of a motion with any number of impacts; z_0 = 1.
class WholePeriod final : public Characteristic {
 public:
  WholePeriod(const ImpulseAnswer& response, const ImpulseTrain& train, const std::vector<double>& times,
              const std::vector<double>& bend, double exchange, bool has_shift)
      : Characteristic(train), times_(times), bend_(bend), exchange_(exchange), has_shift_(has_shift) {
    const std::size_t n = times.size();
    const double period = train.half_period();
    trains_.reserve(n * n);
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        // From impact b to impact a, of which the train sees the answers of later periods: lags l period - delay.
        const double delay = b < a ? period - (times[a] - times[b]) : times[b] - times[a];
        ImpulseAnswer delayed = response;
        for (PowerPart& part : delayed.parts) part.delay += delay;
        for (ImagePart& part : delayed.images) part.delay += delay;
        responses_.push_back(std::make_unique<ImpulseAnswer>(std::move(delayed)));
        trains_.emplace_back(*responses_.back(), period);
      }
    }
  }

  [[nodiscard]] double scale() const override { return std::pow(exchange_, 2 * static_cast<double>(times_.size())); }
  [[nodiscard]] Complex multiplier(Complex log_z) const override { return std::exp(log_z); }

  // The sums have at s = 0 the singular part kappa u v', kappa = h(s)/period, u_a = e^{s t_a} (1, s) and
  // v_b = e^{-s t_b} (1, -s): the determinant of the matrix with it is kappa times that of the matrix without, bordered
  // by u, v and 1/kappa, in which nothing cancels.
  Complex operator()(Complex log_z) const override {
    const std::size_t n = times_.size();
    const Complex s = log_z / train_.half_period();
    const Complex z = std::exp(log_z);
    const bool is_split = std::abs(log_z) < 0.5;
    const std::size_t size = is_split ? 2 * n + 1 : 2 * n;
    std::vector<Complex> matrix(size * size);
    const auto at = [&](std::size_t row, std::size_t column) -> Complex& { return matrix[row * size + column]; };
    Complex mean = 0;
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        const ImpulseTrain& train = trains_[a * n + b];
        std::array<Complex, 3> g;
        if (is_split) {
          const TrainSplit split = train.split(s);
          g = split.regular;
          if (a == 0 && b == 0) mean = split.mean;
        } else {
          g = train.sums(s);
        }
        if (b < a) {
          for (Complex& each : g) each *= z;
        }
        const double own = a == b ? 1 : 0;
        at(a, b) = -g[0];
        at(a, n + b) = g[1] + own * exchange_;
        at(n + a, b) = -g[1] - own * exchange_;
        at(n + a, n + b) = g[2] - own * bend_[a];
      }
    }
    Complex scaled = 1;
    if (is_split) {
      for (std::size_t a = 0; a < n; ++a) {
        const Complex turned = std::exp(s * times_[a]);
        at(a, 2 * n) = turned;
        at(n + a, 2 * n) = s * turned;
        at(2 * n, a) = 1.0 / turned;
        at(2 * n, n + a) = -s / turned;
      }
      at(2 * n, 2 * n) = 1.0 / mean;
      scaled = mean;
    }
    std::vector<Complex> none;
    return scaled * eliminate(matrix, none) / (has_shift_ ? 1.0 - 1.0 / z : 1.0);
  }

 private:
  std::vector<double> times_;
  std::vector<double> bend_;
  double exchange_;
  bool has_shift_;
  std::vector<std::unique_ptr<const ImpulseAnswer>> responses_;  // stay where they are: the trains point at them
  std::vector<ImpulseTrain> trains_;
};

// A point of a path, and D there.
struct Station {
  Complex log_z;
  Complex value;
};

// D, over the distance from a root where one is known: beside that a path would have to take short steps.
class Counted {
 public:
  Counted(const Characteristic& d, std::optional<Complex> known) : d_(d), known_(known) {}
  Complex operator()(Complex log_z) const { return known_ ? quotient(d_(log_z), log_z - *known_) : d_(log_z); }
  /// Change of the argument of that distance between two points of a path right of the root.
  [[nodiscard]] double turn_beside(Complex from, Complex to) const {
    return known_ ? std::arg(to - *known_) - std::arg(from - *known_) : 0;
  }

 private:
  const Characteristic& d_;
  std::optional<Complex> known_;
};

// Change of the argument along straight lines by way of `middle`; NaN where it runs into a root.
double turn(const Counted& d, const Station& from, const Station& middle, const Station& to, int depth) {
  const double first = std::arg(quotient(middle.value, from.value));
  const double second = std::arg(quotient(to.value, middle.value));
  // A smooth function turns evenly, and its middle is not far from the mean of its ends.
  if (std::abs(first) < 1 && std::abs(second) < 1 && std::abs(first - second) < 0.7) return first + second;
  if (depth == 0 || !std::isfinite(first + second)) return std::numeric_limits<double>::quiet_NaN();
  const auto between = [&](const Station& a, const Station& b) {
    const Complex log_z = 0.5 * (a.log_z + b.log_z);
    return turn(d, a, {log_z, d(log_z)}, b, depth - 1);
  };
  return between(from, middle) + between(middle, to);
}

// Roots with Re ln(-z) > edge.  D is real on both lines Im ln(-z) = 0 and pi to the right of the singular point, and
// constant far right: the upper half of the left edge decides.  Left of the singular point the path goes back to it
// along the upper side of the cut.  Negative where the path meets a root.
/// @param known  a root left of the edge, if one is known
int roots_beyond(const Characteristic& characteristic, double edge, std::optional<Complex> known = {}) {
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
  // Every second value of a smooth function is the middle of its neighbours.
  if (!characteristic.is_smooth()) {
    for (std::size_t i = 1; i < path.size(); i += 2)
      path.insert(path.begin() + static_cast<std::ptrdiff_t>(i), 0.5 * (path[i - 1] + path[i]));
  } else if (path.size() % 2 == 0) {
    path.insert(path.begin() + 1, 0.5 * (path[0] + path[1]));
  }
  const Counted d(characteristic, known);
  double total = d.turn_beside(path.front(), path.back());
  Station before{path.front(), d(path.front())};
  for (std::size_t i = 2; i < path.size(); i += 2) {
    const Station middle{path[i - 1], d(path[i - 1])}, after{path[i], d(path[i])};
    total += turn(d, before, middle, after, 16);
    before = after;
  }
  if (!std::isfinite(total)) return -1;
  return static_cast<int>(std::lround(total / pi)) + characteristic.poles_beyond(edge);
}

// Multipliers outside the circle; negative where one lies on it.
int roots_outside(const Characteristic& d) {
  const int count = roots_beyond(d, 0);
  if (count >= 0) return count;
  // Vibrations in flight without damping are poles on the path itself: lines on both sides of them that agree decide.
  constexpr double beside = 1e-3;
  const int left = roots_beyond(d, -beside), right = roots_beyond(d, beside);
  return left == right ? right : count;
}

// Muller's iteration from three points about the start; NaN where it leaves the strip or does not settle at a root.
Complex root_near(const Characteristic& d, Complex start) {
  const double step = 0.1 * std::min(0.5, std::abs(start));
  std::array<Complex, 3> x{start - step, start + step, start};
  std::array<Complex, 3> f{d(x[0]), d(x[1]), d(x[2])};
  const Complex none(std::numeric_limits<double>::quiet_NaN(), 0);
  for (int i = 0; i < 25; ++i) {
    const Complex slope = quotient(f[2] - f[1], x[2] - x[1]);
    const Complex before = quotient(f[1] - f[0], x[1] - x[0]);
    const Complex curvature = quotient(slope - before, x[2] - x[0]);
    const Complex b = slope + curvature * (x[2] - x[1]);
    const Complex root = std::sqrt(b * b - 4.0 * f[2] * curvature);
    const Complex divisor = std::norm(b + root) > std::norm(b - root) ? b + root : b - root;
    Complex change = quotient(-2.0 * f[2], divisor);
    if (std::norm(change) > 1) change /= std::abs(change);
    const Complex next = x[2] + change;
    // D takes conjugate values at conjugate points, and repeats after 2 pi; left of the singular point it has a cut.
    const bool crosses_cut = next.real() < 0 && next.imag() < 0;
    if (!(next.real() > deepest - 1 && next.real() < 40 && next.imag() > -1 && next.imag() < pi + 1) || crosses_cut) {
      return none;
    }
    // Next to a root D is small already.
    if (std::norm(change) < 1e-20 && std::abs(f[2]) < 1e-6 * d.scale()) {
      const double height = next.imag() > pi ? 2 * pi - next.imag() : std::abs(next.imag());
      return next.real() < 0 && height < 1e-6 ? none : Complex(next.real(), height);
    }
    x = {x[1], x[2], next};
    f = {f[1], f[2], d(next)};
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

struct Judgement {
  CycleStability stability;
  bool is_certain;  // by a count no root lies beyond the dominant one
};

Judgement stability_by(const Characteristic& d) {
  // A root is the furthest when none lies beyond a line next to it.
  const auto is_furthest = [&](Complex root) {
    return std::isfinite(root.real()) && roots_beyond(d, root.real() + 1e-3, root) == 0;
  };
  Complex log_z = furthest_root(d, 0, 0, 1, 4);
  bool known = is_furthest(log_z);
  if (!known) {
    // From further left, which finds most of those that the first line leads past.
    const Complex other = furthest_root(d, 0, -0.3, 1, 6);
    if (other.real() > log_z.real()) log_z = other;
    known = is_furthest(log_z);
  }
  CycleStability result{false, known && log_z.real() < -1e-3 ? 0 : roots_outside(d), 0, StabilityLoss::none};
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
  if (d.has_whole_powers() && log_z.real() < -near_point) {
    // The path of the count passes above the axis: its roots are looked for apart.
    const double real = furthest_real_root(d, 0, std::max(deepest, log_z.real()), -near_point);
    if (real > log_z.real()) log_z = real;
  }
  if (std::isfinite(log_z.real())) {
    result.dominant = d.multiplier(log_z);
    if (std::abs(log_z.imag()) < 1e-9 || pi - log_z.imag() < 1e-9) result.dominant = result.dominant.real();
  }
  // A root on the path is one on the circle: neither stable nor counted.
  result.stable = result.unstable_multipliers == 0;
  if (result.unstable_multipliers != 0) {
    result.loss = result.dominant.imag() != 0  ? StabilityLoss::torus
                  : result.dominant.real() < 0 ? StabilityLoss::symmetry_breaking
                                               : StabilityLoss::saddle_node;
  }
  return {result, known};
}

}  // namespace

CycleStability cycle_stability(const ImpulseTrain& train, double exchange) {
  return stability_by(HalfPeriod(train, exchange)).stability;
}

CycleStability forced_stability(const ImpulseTrain& train, double exchange, double acceleration) {
  return stability_by(HalfPeriod(train, exchange, acceleration)).stability;
}

bool is_forced_stable(const ImpulseTrain& train, double exchange, double acceleration) {
  return roots_outside(HalfPeriod(train, exchange, acceleration)) == 0;
}

CycleStability cycle_stability(const ImpulseAnswer& response, const ImpulseTrain& train,
                               const std::vector<double>& times, const std::vector<double>& bend, double exchange,
                               bool is_forced) {
  const Judgement judgement = stability_by(WholePeriod(response, train, times, bend, exchange, !is_forced));
  CycleStability result = judgement.stability;
  // The search from a few points may lead past the largest of so many impacts.
  if (result.stable && times.size() > 6 && !judgement.is_certain) result.dominant = NAN;
  if (result.loss == StabilityLoss::symmetry_breaking) result.loss = StabilityLoss::period_doubling;
  return result;
}

}  // namespace backlash::detail
