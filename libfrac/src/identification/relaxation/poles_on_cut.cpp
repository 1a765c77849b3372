// SPDX-License-Identifier: BSD-3-Clause
#include "poles_on_cut.hpp"

#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "cut_value.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
using Places = std::vector<double>;  // ln tau, rising

// Rounding of an order of 1/2 or 1 leaves 1e-16 of the other part.
bool is_real(Complex value) {
  return std::abs(value.imag()) <= 1e-9 * std::abs(value);
}
bool is_imaginary(Complex value) {
  return std::abs(value.real()) <= 1e-9 * std::abs(value);
}

/// Those closer than two can be told apart are one.
Places merged(Places one, const Places& other) {
  constexpr double apart = 1e-7;
  one.insert(one.end(), other.begin(), other.end());
  std::sort(one.begin(), one.end());
  one.erase(std::unique(one.begin(), one.end(), [](double a, double b) { return b - a < apart; }), one.end());
  return one;
}

/// A value of a function.
struct Point {
  double log_tau, value;
};

template <class Function>
double root_of(const Function& f, Point low, Point high) {
  if (low.value == 0) return low.log_tau;
  if (high.value == 0) return high.log_tau;
  std::uintmax_t most = 100;
  const auto [a, b] = boost::math::tools::toms748_solve(f, low.log_tau, high.log_tau, low.value, high.value,
                                                        boost::math::tools::eps_tolerance<double>(), most);
  return (a + b) / 2;
}

class Search {
 public:
  Search(const Expression& expression, std::span<const double> parameters, double first, double last)
      : expression_(expression),
        value_(expression, parameters),
        grid_(grid(first, last)),
        poles_(expression.nodes.size()),
        zeros_(expression.nodes.size()) {
    shorten();
  }

  [[nodiscard]] PossiblePoles poles_of_whole() {
    return {poles(static_cast<int>(expression_.nodes.size()) - 1), left_off_};
  }

 private:
  static Places grid(double first, double last) {
    constexpr double per_e_fold = 20;
    const auto steps = static_cast<std::size_t>(std::ceil((last - first) * per_e_fold));
    Places result;
    for (std::size_t i = 0; i <= steps; ++i)
      result.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(steps));
    return result;
  }

  [[nodiscard]] const Node& node(int index) const { return expression_.nodes[static_cast<std::size_t>(index)]; }
  [[nodiscard]] Complex value(int index, double log_tau) { return value_.of(index, std::exp(-log_tau)); }

  /// Half turns of an argument between two times.
  [[nodiscard]] double turns(int argument, double from, double to) {
    if (!is_imaginary(value(argument, (from + to) / 2))) return 0;
    const double angle = std::abs(value(argument, to).imag() - value(argument, from).imag());
    return std::isfinite(angle) ? angle / std::numbers::pi : 0;
  }

  /// Leaves off the short times at which a series of poles has more than can be listed.
  void shorten() {
    constexpr double most = 1000;
    std::size_t start = 0;
    double beyond = 0;
    for (std::size_t i = 0; i < expression_.nodes.size(); ++i) {
      if (!is_periodic(expression_.nodes[i])) continue;
      double all = 0, kept = 0;
      for (std::size_t k = grid_.size() - 1; k > 0; --k) {
        all += turns(expression_.nodes[i].left, grid_[k - 1], grid_[k]);
        if (all <= most) {
          kept = all;
        } else {
          start = std::max(start, k);
        }
      }
      beyond += all - kept;
    }
    left_off_ = static_cast<std::size_t>(beyond);
    grid_.erase(grid_.begin(), grid_.begin() + static_cast<std::ptrdiff_t>(start));
  }

  static bool is_periodic(const Node& of) {
    switch (of.operation) {
      case Operation::tanh:
      case Operation::coth:
      case Operation::sech:
      case Operation::sinh:
      case Operation::cosh:
        return of.has_s;
      default:
        return false;
    }
  }

  const Places& poles(int index) {
    auto& known = poles_[static_cast<std::size_t>(index)];
    if (!known) known = node(index).has_s ? poles_of(node(index)) : Places{};
    return *known;
  }
  const Places& zeros(int index) {
    auto& known = zeros_[static_cast<std::size_t>(index)];
    if (!known) known = node(index).has_s ? zeros_of(index) : Places{};
    return *known;
  }

  Places poles_of(const Node& of) {
    switch (of.operation) {
      case Operation::add:
      case Operation::subtract:
      case Operation::multiply:
        return merged(poles(of.left), poles(of.right));
      case Operation::divide:
        return merged(poles(of.left), zeros(of.right));
      case Operation::negate:
      case Operation::sqrt:
        return poles(of.left);
      case Operation::power:
        return exponent(of) > 0 ? poles(of.left) : zeros(of.left);
      case Operation::tanh:
      case Operation::sech:
        return turned(of.left, 0.5);
      case Operation::coth:
        return merged(turned(of.left, 0), zeros(of.left));
      default:
        return {};
    }
  }

  Places zeros_of(int index) {
    const Node& of = node(index);
    switch (of.operation) {
      case Operation::add:
      case Operation::subtract:
        return sign_changes(index);
      case Operation::multiply:
        return merged(zeros(of.left), zeros(of.right));
      case Operation::divide:
        return merged(zeros(of.left), poles(of.right));
      case Operation::negate:
      case Operation::sqrt:
        return zeros(of.left);
      case Operation::power:
        return exponent(of) > 0 ? zeros(of.left) : poles(of.left);
      case Operation::tanh:
      case Operation::sinh:
        return merged(turned(of.left, 0), zeros(of.left));
      case Operation::coth:
      case Operation::cosh:
        return turned(of.left, 0.5);
      case Operation::log:
        return sign_changes(index);
      default:
        return {};
    }
  }

  [[nodiscard]] double exponent(const Node& of) { return value(of.right, 0).real(); }

  /// Rates at which an argument is j pi (k + offset), but for 0.  Its turning is the same way between two times of the
  /// grid, or between one and a zero, where a root may turn from real to imaginary.
  Places turned(int argument, double offset) {
    const Places ends = merged(grid_, zeros(argument));
    Places result;
    for (std::size_t i = 1; i < ends.size(); ++i) {
      if (!is_imaginary(value(argument, (ends[i - 1] + ends[i]) / 2))) continue;
      const double from = value(argument, ends[i - 1]).imag(), to = value(argument, ends[i]).imag();
      if (!std::isfinite(from) || !std::isfinite(to)) continue;
      // The end at which a turn is full belongs to the interval after it.
      const auto turns_at = [&](double angle) { return std::ceil(angle / std::numbers::pi - offset); };
      for (double k = turns_at(std::min(from, to)); k < turns_at(std::max(from, to)); ++k) {
        const double level = (k + offset) * std::numbers::pi;
        if (level == 0 || (from - level) * (to - level) > 0) continue;
        result.push_back(root_of([&](double t) { return value(argument, t).imag() - level; },
                                 {ends[i - 1], from - level}, {ends[i], to - level}));
      }
    }
    return merged(std::move(result), {});
  }

  /// Zeros of a sum where it is real: a pole and a zero of a sum of relaxations alternate (Foster), so that each of its
  /// intervals between poles is searched by itself.
  Places sign_changes(int index) {
    Places ends = poles(index);
    ends.insert(ends.begin(), grid_.front());
    ends.push_back(grid_.back());
    Places result;
    for (std::size_t i = 1; i < ends.size(); ++i) {
      // Near a pole rounding leaves no sign; a zero closer to it makes a line of next to no area.
      const double nudge = 1e-8 * (ends[i] - ends[i - 1]);
      if (!(nudge > 0)) continue;
      Places points{ends[i - 1] + nudge};
      std::copy_if(grid_.begin(), grid_.end(), std::back_inserter(points),
                   [&](double t) { return t > ends[i - 1] + nudge && t < ends[i] - nudge; });
      if (points.size() == 1) points.push_back((ends[i - 1] + ends[i]) / 2);
      points.push_back(ends[i] - nudge);
      // Without the poles at its ends the function is smooth.
      search(points, result, [&](double t) { return (t - ends[i - 1]) * (ends[i] - t) * value(index, t); });
    }
    return merged(std::move(result), {});
  }

  template <class Function>
  static void search(const Places& points, Places& result, const Function& f) {
    const auto real_part = [&](double t) { return f(t).real(); };
    std::vector<Complex> at;
    for (const double t : points) at.push_back(f(t));
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (!is_real(at[i - 1]) || !is_real(at[i])) continue;
      if ((at[i - 1].real() < 0) != (at[i].real() < 0)) {
        result.push_back(root_of(real_part, {points[i - 1], at[i - 1].real()}, {points[i], at[i].real()}));
      } else if (i + 1 < points.size() && std::abs(at[i]) <= std::abs(at[i - 1]) &&
                 std::abs(at[i]) <= std::abs(at[i + 1])) {
        // Two zeros may stand between two points.
        const double sign = at[i].real() < 0 ? -1 : 1;
        const auto [least, value] = boost::math::tools::brent_find_minima([&](double t) { return sign * real_part(t); },
                                                                          points[i - 1], points[i + 1], 30);
        if (!(value < 0) || !is_real(at[i + 1]) || (at[i + 1].real() < 0) != (at[i].real() < 0)) continue;
        const Point between{least, sign * value};
        result.push_back(root_of(real_part, {points[i - 1], at[i - 1].real()}, between));
        result.push_back(root_of(real_part, between, {points[i + 1], at[i + 1].real()}));
      }
    }
  }

  const Expression& expression_;
  CutValue value_;
  Places grid_;
  std::vector<std::optional<Places>> poles_, zeros_;
  std::size_t left_off_ = 0;
};

}  // namespace

PossiblePoles possible_poles(const Expression& expression, std::span<const double> parameters, double first,
                             double last) {
  return Search(expression, parameters, first, last).poles_of_whole();
}

}  // namespace frac::detail
