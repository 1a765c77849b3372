// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/judging/evidence_bound.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "benchmarks/judging/least_squares.hpp"
#include "benchmarks/judging/price_of_an_order.hpp"

namespace judging {
namespace {

constexpr int kLargestOrder = 12;
/// Curves are thinned to this many points at most, and their losses scaled back.
constexpr std::size_t kMostPoints = 100;

/// The exact curve as weighted rows: frequency relative to the middle of the band, value relative to its middle size.
class Target {
 public:
  explicit Target(const Curve& curve) : imaginary_only_(curve.setting.imaginary_only), correlation_(curve.correlation) {
    const std::size_t count = curve.omega.size();
    const std::size_t stride = (count + kMostPoints - 1) / kMostPoints;
    double mean = 0;
    for (const double w : curve.omega) mean += std::log(w) / static_cast<double>(count);
    unit_ = std::exp(mean);
    for (std::size_t i = 0; i < count; i += stride) {
      s_.emplace_back(0, curve.omega[i] / unit_);
      value_.push_back(curve.exact[i]);
      sigma_real_.push_back(curve.sigma_real[i]);
      sigma_imaginary_.push_back(curve.sigma_imaginary[i]);
    }
    // A smooth error is seen (1 - r)/(1 + r) times as well through correlated noise; thinned noise has r^stride.
    const auto seen = [](double r) { return (1 - r) / (1 + r); };
    const double thinned = std::pow(correlation_, static_cast<double>(stride));
    scale_ = curve.sound * static_cast<double>(stride) * seen(correlation_) / seen(thinned);
    correlation_ = thinned;
    residuals_ = static_cast<double>(count) * (imaginary_only_ ? 1 : 2);
    rows_ = rows(value_);
  }

  [[nodiscard]] std::vector<double> rows(const std::vector<Complex>& value) const {
    std::vector<double> result;
    const auto whiten = [&](auto part) {
      double previous = 0;
      for (std::size_t i = 0; i < value.size(); ++i) {
        const double now = part(i);
        result.push_back(i == 0 ? now : (now - correlation_ * previous) / std::sqrt(1 - correlation_ * correlation_));
        previous = now;
      }
    };
    if (!imaginary_only_) whiten([&](std::size_t i) { return value[i].real() / sigma_real_[i]; });
    whiten([&](std::size_t i) { return value[i].imag() / sigma_imaginary_[i]; });
    return result;
  }

  [[nodiscard]] double loss(double sum_of_squares) const { return 0.5 * scale_ * sum_of_squares; }
  [[nodiscard]] double price(double parameters) const { return 0.5 * parameters * std::log(residuals_); }
  [[nodiscard]] const std::vector<Complex>& s() const { return s_; }
  [[nodiscard]] const std::vector<Complex>& value() const { return value_; }
  [[nodiscard]] const std::vector<double>& rows() const { return rows_; }
  [[nodiscard]] double unit() const { return unit_; }
  [[nodiscard]] double scale() const { return scale_; }

 private:
  bool imaginary_only_;
  double correlation_;
  double unit_ = 1;
  double scale_ = 1;
  double residuals_ = 0;
  std::vector<Complex> s_;
  std::vector<Complex> value_;
  std::vector<double> sigma_real_;
  std::vector<double> sigma_imaginary_;
  std::vector<double> rows_;
};

/// Denominators in factors s^2 + b1 s + b0, and s + p for the last of an odd number.
using Factors = std::vector<double>;

/// Poles of the factors: a real one twice as parts of 0 imaginary part, a pair as one of positive imaginary part.
Factors factors_of(std::vector<Complex> poles) {
  Factors result;
  std::vector<double> real;
  for (const Complex& p : poles) {
    if (p.imag() > 1e-9 * std::abs(p)) {
      result.push_back(-2 * p.real());
      result.push_back(std::norm(p));
    } else if (std::abs(p.imag()) <= 1e-9 * std::abs(p)) {
      real.push_back(p.real());
    }
  }
  std::sort(real.begin(), real.end());
  for (std::size_t i = 0; i + 1 < real.size(); i += 2) {
    result.push_back(-real[i] - real[i + 1]);
    result.push_back(real[i] * real[i + 1]);
  }
  if (real.size() % 2 == 1) result.push_back(-real.back());
  return result;
}

/// Partial fractions with the given poles: one column per real pole, two per pair.
std::vector<std::vector<Complex>> partial_fractions(const std::vector<Complex>& poles, const std::vector<Complex>& s) {
  std::vector<std::vector<Complex>> columns;
  for (const Complex& p : poles) {
    std::vector<Complex> first;
    std::vector<Complex> second;
    for (const Complex& x : s) {
      if (p.imag() == 0) {
        first.push_back(std::abs(p) / (x - p));
      } else {
        const Complex denominator = (x - p) * (x - std::conj(p));
        first.push_back(x * std::abs(p) / denominator);
        second.push_back(std::norm(p) / denominator);
      }
    }
    columns.push_back(std::move(first));
    if (p.imag() != 0) columns.push_back(std::move(second));
  }
  return columns;
}

/// Zeros of 1 + sum of c_k times the partial fractions, by Aberth's iteration from the poles.
std::vector<Complex> zeros_of(const std::vector<Complex>& poles, const std::vector<double>& c) {
  std::vector<Complex> all;
  for (const Complex& p : poles) {
    all.push_back(p);
    if (p.imag() != 0) all.push_back(std::conj(p));
  }
  const auto logarithmic_derivative = [&](Complex x) {
    Complex sum = 1;
    Complex derivative = 0;
    Complex from_poles = 0;
    std::size_t k = 0;
    for (const Complex& p : poles) {
      if (p.imag() == 0) {
        const Complex d = x - p;
        sum += c[k] * std::abs(p) / d;
        derivative -= c[k] * std::abs(p) / (d * d);
        from_poles += 1.0 / d;
        k += 1;
      } else {
        const Complex d = (x - p) * (x - std::conj(p));
        const Complex slope = 2.0 * x - 2 * p.real();
        const Complex numerator = c[k] * std::abs(p) * x + c[k + 1] * std::norm(p);
        sum += numerator / d;
        derivative += c[k] * std::abs(p) / d - numerator * slope / (d * d);
        from_poles += slope / d;
        k += 2;
      }
    }
    return derivative / sum + from_poles;
  };
  std::vector<Complex> zeros;
  for (std::size_t i = 0; i < all.size(); ++i) {
    zeros.push_back(all[i] * std::polar(1.03, 0.05 + 0.01 * static_cast<double>(i)));
  }
  for (int iteration = 0; iteration < 60; ++iteration) {
    double largest = 0;
    for (std::size_t i = 0; i < zeros.size(); ++i) {
      Complex repulsion = 0;
      for (std::size_t j = 0; j < zeros.size(); ++j) {
        if (j != i) repulsion += 1.0 / (zeros[i] - zeros[j]);
      }
      const Complex step = 1.0 / (logarithmic_derivative(zeros[i]) - repulsion);
      if (!std::isfinite(std::abs(step))) continue;
      zeros[i] -= step;
      largest = std::max(largest, std::abs(step) / (std::abs(zeros[i]) + 1e-300));
    }
    if (largest < 1e-12) break;
  }
  // Conjugate pairs come out as two: one is kept, and what is nearly real becomes real.
  std::vector<Complex> kept;
  std::vector<bool> used(zeros.size(), false);
  for (std::size_t i = 0; i < zeros.size(); ++i) {
    if (used[i]) continue;
    used[i] = true;
    if (std::abs(zeros[i].imag()) < 1e-7 * std::abs(zeros[i])) {
      kept.emplace_back(zeros[i].real(), 0);
      continue;
    }
    std::size_t partner = i;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < zeros.size(); ++j) {
      const double distance = std::abs(zeros[j] - std::conj(zeros[i]));
      if (!used[j] && distance < nearest) {
        nearest = distance;
        partner = j;
      }
    }
    if (partner == i || nearest > 1e-3 * std::abs(zeros[i])) {
      kept.emplace_back(zeros[i].real(), 0);
    } else {
      used[partner] = true;
      kept.emplace_back(zeros[i].real(), std::abs(zeros[i].imag()));
    }
  }
  return kept;
}

std::vector<double> times_value(const Target& target, const std::vector<Complex>& column, double sign) {
  std::vector<Complex> product(column.size());
  for (std::size_t i = 0; i < column.size(); ++i) product[i] = sign * column[i] * target.value()[i];
  return target.rows(product);
}

std::vector<Complex> delayed(const Target& target, std::vector<Complex> column, double delay) {
  for (std::size_t i = 0; i < column.size(); ++i) column[i] *= std::exp(-delay * target.s()[i]);
  return column;
}

/// Poles by vector fitting, started from `poles`.
std::vector<Complex> relocate(const Target& target, std::vector<Complex> poles, double delay, int iterations) {
  const std::size_t count = target.s().size();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    const auto fractions = partial_fractions(poles, target.s());
    Columns columns;
    for (const auto& column : fractions) columns.push_back(target.rows(delayed(target, column, delay)));
    columns.push_back(target.rows(delayed(target, std::vector<Complex>(count, 1), delay)));
    const std::size_t first = columns.size();
    for (const auto& column : fractions) columns.push_back(times_value(target, column, -1));
    const std::vector<double> x = solve_least_squares(columns, target.rows()).first;
    const std::vector<double> c(x.begin() + static_cast<std::ptrdiff_t>(first), x.end());
    std::vector<Complex> next = zeros_of(poles, c);
    const bool sound = std::all_of(next.begin(), next.end(), [](const Complex& p) {
      return std::isfinite(std::abs(p)) && std::abs(p) > 1e-9 && std::abs(p) < 1e9;
    });
    if (!sound || next.empty()) break;
    poles = std::move(next);
  }
  return poles;
}

/// Weighted columns of a ratio with denominators in factors; theta holds the factors and, with dead time, its length.
Columns rational_columns(const Target& target, const std::vector<double>& theta, std::size_t order, bool improper) {
  const double delay = theta.size() > order ? theta[order] : 0;
  const std::size_t count = target.s().size();
  Columns columns;
  const auto add = [&](const std::function<Complex(Complex)>& f) {
    std::vector<Complex> column(count);
    for (std::size_t i = 0; i < count; ++i) column[i] = f(target.s()[i]) * std::exp(-delay * target.s()[i]);
    columns.push_back(target.rows(column));
  };
  for (std::size_t i = 0; i + 1 < order; i += 2) {
    const double b1 = theta[i];
    const double b0 = theta[i + 1];
    add([=](Complex s) { return 1.0 / (s * s + b1 * s + b0); });
    add([=](Complex s) { return s / (s * s + b1 * s + b0); });
  }
  if (order % 2 == 1) {
    const double p = theta[order - 1];
    add([=](Complex s) { return 1.0 / (s + p); });
  }
  add([](Complex) { return Complex(1); });
  if (improper) add([](Complex s) { return s; });
  return columns;
}

struct RationalFit {
  double loss = std::numeric_limits<double>::infinity();
};

RationalFit fit_rational(const Target& target, int order, double delay, bool improper) {
  const auto n = static_cast<std::size_t>(order);
  const double low = std::abs(target.s().front());
  const double high = std::abs(target.s().back());
  RationalFit best;
  for (const bool oscillating : {false, true}) {
    if (oscillating && order == 1) break;
    std::vector<Complex> poles;
    const int pairs = oscillating ? order / 2 : 0;
    const int parts = order - pairs;
    for (int i = 0; i < parts; ++i) {
      const double size = low * std::pow(high / low, (i + 0.5) / parts);
      poles.push_back(i < pairs ? Complex(-0.05 * size, size) : Complex(-size, 0));
    }
    poles = relocate(target, poles, delay, 10);
    Factors theta = factors_of(poles);
    if (theta.size() != n) continue;
    if (delay > 0) theta.push_back(delay);
    const ProjectedFit fit =
        fit_by_projection([&](const std::vector<double>& t) { return rational_columns(target, t, n, improper); },
                          target.rows(), theta, 15);
    best.loss = std::min(best.loss, target.loss(fit.cost));
  }
  return best;
}

struct Rival {
  std::string name;
  double loss = std::numeric_limits<double>::infinity();
  double energy = std::numeric_limits<double>::infinity();
  int order = 0;
  bool delay = false;
};

Rival best_rational(const Target& target, const System& system) {
  Rival best;
  std::vector<double> delays = {0};
  const double length = system.delay * target.unit();
  const double highest = std::abs(target.s().back());
  if (length > 0) {
    delays.insert(delays.end(), {length, 1.2 * length, 1.5 * length});
  } else {
    delays.insert(delays.end(), {0.3 / highest, 3 / highest});
  }
  for (const double delay : delays) {
    double last = std::numeric_limits<double>::infinity();
    for (int order = 1; order <= kLargestOrder; ++order) {
      const double parameters = 2 * order + 1 + (delay > 0 ? 1 : 0);
      // More parameters can no longer pay once their price alone is above the best.
      if (target.price(parameters) >= best.energy) break;
      for (const bool improper : {false, true}) {
        if (improper && delay > 0) break;
        const double loss = fit_rational(target, order, delay, improper).loss;
        const double energy = loss + target.price(parameters + (improper ? 1 : 0));
        if (energy < best.energy) best = {"rational", loss, energy, order, delay > 0};
        last = loss;
      }
      if (last < 1e-3) break;
    }
  }
  return best;
}

/// Order between 0 and 2 from an unlimited number.
double order_from(double t) {
  return 2 / (1 + std::exp(-t));
}
double unlimited_from(double order) {
  return -std::log(2 / order - 1);
}

struct FractionalStructure {
  const char* name;
  /// Columns of what enters linearly, as functions of s.
  std::function<std::vector<std::function<Complex(Complex)>>(const std::vector<double>&)> basis;
  std::vector<std::vector<double>> starts;
  int linear;
  /// Which of the nonlinear parameters are orders written by `unlimited_from`.
  std::vector<std::size_t> orders;
};

/// Ratios of polynomials in s^a of degree 2 or 3, with or without dead time: theta holds the order, s^2a + b1 s^a + b0
/// by b1 and ln b0, ln p of s^a + p, and the dead time.
FractionalStructure commensurate(const char* name, bool third, bool delay) {
  FractionalStructure structure;
  structure.name = name;
  structure.linear = third ? 4 : 3;
  structure.orders = {0};
  structure.basis = [third, delay](const std::vector<double>& t) {
    const double order = order_from(t[0]);
    const double b1 = t[1];
    const double b0 = std::exp(t[2]);
    const double length = delay ? t.back() : 0;
    const auto held = [=](Complex s, Complex value) { return delay ? value * std::exp(-length * s) : value; };
    const auto quadratic = [=](Complex z) { return z * z + b1 * z + b0; };
    std::vector<std::function<Complex(Complex)>> columns = {
        [=](Complex s) { return held(s, 1); }, [=](Complex s) { return held(s, 1.0 / quadratic(std::pow(s, order))); },
        [=](Complex s) {
          const Complex z = std::pow(s, order);
          return held(s, z / quadratic(z));
        }};
    if (third) {
      const double pole = std::exp(t[3]);
      columns.emplace_back([=](Complex s) { return held(s, 1.0 / (std::pow(s, order) + pole)); });
    }
    return columns;
  };
  for (const double order : {0.6, 0.85}) {
    for (const double spread : {1.0, 3.0}) {
      // Poles at exp(-spread) and exp(spread) in s^a, and a third between them or beyond.
      std::vector<double> start = {unlimited_from(order), 2 * std::cosh(spread), 0};
      if (third) start.push_back(spread > 2 ? 0 : 2);
      if (delay) start.push_back(0.01);
      structure.starts.push_back(start);
    }
  }
  return structure;
}

std::vector<FractionalStructure> fractional_structures() {
  using Function = std::function<Complex(Complex)>;
  const auto u = unlimited_from;
  const auto a = order_from;
  return {
      {"power",
       [a](const auto& t) {
         const double p = 2 * a(t[0]) - 2;
         return std::vector<Function>{[p](Complex s) { return std::pow(s, p); }};
       },
       {{u(0.6)}, {u(1.4)}},
       1,
       {}},
      {"powers",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double q = a(t[1]);
         return std::vector<Function>{[p](Complex s) { return std::pow(s, p); },
                                      [q](Complex s) { return std::pow(s, -q); }, [](Complex) { return Complex(1); }};
       },
       {{u(0.5), u(0.5)}, {u(0.9), u(0.5)}, {u(0.5), u(1.2)}, {u(1.3), u(1.3)}},
       3,
       {0, 1}},
      {"lag-and-delay",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double time = std::exp(t[1]);
         const double delay = t[2];
         return std::vector<Function>{[=](Complex s) { return std::exp(-delay * s) / (1.0 + std::pow(time * s, p)); }};
       },
       {{u(0.7), 0, 0.01}, {u(0.9), 3, 0.1}, {u(1.3), 0, 0.01}, {u(1.3), 1, 0.1}, {u(0.7), -2, 0.01}},
       1,
       {0}},
      {"arc-on-a-floor",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double time = std::exp(t[1]);
         return std::vector<Function>{[](Complex) { return Complex(1); },
                                      [=](Complex s) { return 1.0 / (1.0 + std::pow(time * s, p)); }};
       },
       {{u(0.7), 0}, {u(0.7), 2.5}, {u(0.7), -2.5}, {u(1.3), 0}},
       2,
       {0}},
      {"havriliak-negami",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double time = std::exp(t[1]);
         const double b = std::exp(t[2]);
         return std::vector<Function>{[=](Complex s) { return std::pow(1.0 + std::pow(time * s, p), -b); }};
       },
       {{u(0.8), 0, -0.5}, {u(1), 1, -0.5}, {u(1), 0, 0.7}, {u(1.2), -1, 0.3}, {u(0.7), 3, -0.3}},
       1,
       {0}},
      {"two-orders",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double q = p + a(t[1]);
         const double b1 = std::exp(t[2]);
         const double b0 = std::exp(t[3]);
         return std::vector<Function>{[=](Complex s) { return 1.0 / (std::pow(s, q) + b1 * std::pow(s, p) + b0); }};
       },
       {{u(0.7), u(1), 0, 0},
        {u(0.5), u(1.4), 0, 0},
        {u(0.9), u(0.9), 1, 0},
        {u(0.9), u(1.2), -1, 0},
        {u(0.8), u(0.8), 0, -2}},
       1,
       {0, 1}},
      {"power-times-lag",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double time = std::exp(t[1]);
         const double q = 2 * a(t[2]) - 2;
         return std::vector<Function>{[=](Complex s) { return std::pow(s, q) / (1.0 + std::pow(time * s, p)); }};
       },
       {{u(0.9), 0, u(0.6)}, {u(0.9), 0, u(1.3)}, {u(0.7), 1, u(0.8)}},
       1,
       {0}},
      {"two-arcs-on-a-floor",
       [a](const auto& t) {
         const double p = a(t[0]);
         const double time1 = std::exp(t[1]);
         const double q = a(t[2]);
         const double time2 = std::exp(t[3]);
         return std::vector<Function>{[](Complex) { return Complex(1); },
                                      [=](Complex s) { return 1.0 / (1.0 + std::pow(time1 * s, p)); },
                                      [=](Complex s) { return 1.0 / (1.0 + std::pow(time2 * s, q)); }};
       },
       {{u(0.8), 1, u(0.8), -1}, {u(0.8), 3, u(0.8), -1}, {u(0.8), 1, u(0.8), -3}, {u(0.9), 4, u(0.7), -4}},
       3,
       {0, 2}},
      commensurate("commensurate-2", false, false),
      commensurate("commensurate-2-and-delay", false, true),
      commensurate("commensurate-3", true, false),
      commensurate("commensurate-3-and-delay", true, true),
  };
}

Rival best_fractional(const Target& target) {
  Rival best;
  for (const FractionalStructure& structure : fractional_structures()) {
    const auto columns = [&](const std::vector<double>& t) {
      Columns result;
      for (const auto& function : structure.basis(t)) {
        std::vector<Complex> column;
        for (const Complex& s : target.s()) column.push_back(function(s));
        result.push_back(target.rows(column));
      }
      return result;
    };
    const double price = target.price(static_cast<double>(structure.starts.front().size()) + structure.linear);
    if (price >= best.energy) continue;
    for (const auto& start : structure.starts) {
      const ProjectedFit fit = fit_by_projection(columns, target.rows(), start, 40);
      const double loss = target.loss(fit.cost);
      // With all its orders whole a structure is an integer-order one, whose price the nested rival tells.
      const bool whole = !structure.orders.empty() &&
                         std::all_of(structure.orders.begin(), structure.orders.end(), [&](std::size_t i) {
                           const double order = order_from(fit.nonlinear[i]);
                           return std::abs(order - std::round(order)) < 2e-3;
                         });
      if (!whole && loss + price < best.energy) best = {structure.name, loss, loss + price, 0, false};
    }
  }
  return best;
}

/// Price of the order of the system over frequency.
double price_of_the_order(const Target& target, const System& system) {
  const auto curve = [&](const std::vector<double>& p, double order) {
    std::vector<Complex> value;
    for (const Complex& s : target.s()) value.push_back(system.response(p, order, s * target.unit()));
    return target.rows(value);
  };
  return price_of_an_order(curve, system.parameters, {target.rows()}, target.scale());
}

}  // namespace

std::string Bound::word() const {
  if (log_odds - deviation > std::log(20.0)) return "decidable";
  if (log_odds > std::log(3.0)) return "close";
  return log_odds < -std::log(3.0) ? "misleading" : "open";
}

Bound evidence_bound(const Kind& kind, const System& system, const Curve& curve) {
  const Target target(curve);
  const Rival rational = best_rational(target, system);
  const Rival other = best_fractional(target);
  const double own_price = target.price(system.free_parameters(kind.fractional));
  Bound bound;
  bound.rational_order = rational.order;
  bound.rational_delay = rational.delay;
  bound.rational_loss = rational.loss;
  bound.fractional_name = other.name;
  bound.fractional_loss = other.loss;
  if (kind.fractional) {
    bound.log_odds = rational.energy - std::min(other.energy, own_price);
    bound.deviation = std::sqrt(2 * rational.loss);
    return bound;
  }
  const double own = kind.within_family ? std::min(rational.energy, own_price) : rational.energy;
  bound.log_odds = other.energy - own;
  bound.deviation = std::sqrt(2 * other.loss);
  if (kind.within_family) {
    const double nested = own_price - own + price_of_the_order(target, system);
    if (nested < bound.log_odds) {
      bound.log_odds = nested;
      // The overfit of one parameter is half a chi-square of one degree of freedom.
      bound.deviation = std::sqrt(0.5);
      bound.fractional_name = "order-freed";
      bound.fractional_loss = 0;
    }
  }
  return bound;
}

double rational_loss(const Curve& curve, int order) {
  return fit_rational(Target(curve), order, 0, false).loss;
}

}  // namespace judging
