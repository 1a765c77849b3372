// SPDX-License-Identifier: BSD-3-Clause
#include "cut_plane.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

namespace frac::detail {
namespace {

constexpr double pi = std::numbers::pi;
// Angles are sums of multiples of orders, and equal ones differ by the rounding of these.
constexpr double rounding = 1e-12;

/// Of arguments, for 0 <= arg s < pi; an end is attained or only approached.
struct Sector {
  struct End {
    double angle;
    bool is_attained;
  };
  End lower, upper;

  [[nodiscard]] double width() const { return upper.angle - lower.angle; }
  [[nodiscard]] double middle() const { return (lower.angle + upper.angle) / 2; }
};

Sector turned(const Sector& sector, double angle) {
  return {{sector.lower.angle + angle, sector.lower.is_attained},
          {sector.upper.angle + angle, sector.upper.is_attained}};
}

/// The same arguments with their middle within a half turn of an angle.
Sector turned_to(const Sector& sector, double angle) {
  return turned(sector, -2 * pi * std::round((sector.middle() - angle) / (2 * pi)));
}

Sector sum_of(const Sector& a, const Sector& b) {
  const auto end = [](const Sector::End& x, const Sector::End& y) {
    return Sector::End{x.angle + y.angle, x.is_attained && y.is_attained};
  };
  return {end(a.lower, b.lower), end(a.upper, b.upper)};
}

Sector times(const Sector& sector, double factor) {
  if (factor == 0) return {{0, true}, {0, true}};
  Sector::End lower{sector.lower.angle * factor, sector.lower.is_attained};
  Sector::End upper{sector.upper.angle * factor, sector.upper.is_attained};
  if (factor < 0) std::swap(lower, upper);
  return {lower, upper};
}

/// Both sectors and what lies between them.
Sector hull(const Sector& a, const Sector& b) {
  const auto outer = [](const Sector::End& x, const Sector::End& y, bool lower) {
    if (std::abs(x.angle - y.angle) <= rounding) return Sector::End{x.angle, x.is_attained || y.is_attained};
    return (x.angle < y.angle) == lower ? x : y;
  };
  return {outer(a.lower, b.lower, true), outer(a.upper, b.upper, false)};
}

/// Whether all arguments lie within the angle to either side of the positive axis, the angle itself left out.
bool is_within(const Sector& sector, double angle) {
  const Sector near = turned_to(sector, 0);
  const auto inside = [&](const Sector::End& end) {
    return std::abs(end.angle) < angle - rounding || (std::abs(end.angle) <= angle + rounding && !end.is_attained);
  };
  return inside(near.lower) && inside(near.upper);
}

/// What is known of a part of a formula in the plane cut along the negative axis.
struct Part {
  bool is_analytic = false;
  bool vanishes_nowhere = false;
  bool is_zero = false;          // a number that is 0
  std::optional<Sector> sector;  // not known: any argument

  [[nodiscard]] bool keeps_off_the_cut() const {
    return is_analytic && vanishes_nowhere && sector && is_within(*sector, pi);
  }
  [[nodiscard]] bool has_positive_real_part() const {
    return is_analytic && vanishes_nowhere && sector && is_within(*sector, pi / 2);
  }
};

Part real_part_of_formula(double value) {
  if (value == 0) return {.is_analytic = true, .vanishes_nowhere = false, .is_zero = true, .sector = std::nullopt};
  const double angle = value > 0 ? 0 : pi;
  return {std::isfinite(value), true, false, Sector{{angle, true}, {angle, true}}};
}

Part sum(const Part& a, const Part& b) {
  if (a.is_zero) return b;
  if (b.is_zero) return a;
  Part result{a.is_analytic && b.is_analytic, false, false, std::nullopt};
  // Where one part vanishes, the other is the sum.
  if (!a.sector || !b.sector || !(a.vanishes_nowhere || b.vanishes_nowhere)) return result;
  const Sector both = hull(*a.sector, turned_to(*b.sector, a.sector->middle()));
  const bool opposite = both.lower.is_attained && both.upper.is_attained;
  if (!(both.width() < pi - rounding || (both.width() <= pi + rounding && !opposite))) return result;
  result.vanishes_nowhere = true;
  result.sector = both;
  return result;
}

Part product(const Part& a, const Part& b) {
  Part result{a.is_analytic && b.is_analytic, a.vanishes_nowhere && b.vanishes_nowhere, false, std::nullopt};
  if (a.sector && b.sector) result.sector = sum_of(*a.sector, *b.sector);
  return result;
}

Part power(const Part& base, double exponent) {
  const bool is_whole = exponent == std::round(exponent);
  Part result{base.is_analytic && std::isfinite(exponent), base.vanishes_nowhere, false, std::nullopt};
  if (is_whole) {
    result.is_analytic = result.is_analytic && (exponent >= 0 || base.vanishes_nowhere);
    if (base.sector) result.sector = times(*base.sector, exponent);
    return result;
  }
  if (!base.keeps_off_the_cut()) return {};
  result.sector = times(turned_to(*base.sector, 0), exponent);
  return result;
}

Part reciprocal(const Part& divisor) {
  return power(divisor, -1);
}

Part negative(const Part& part) {
  Part result = part;
  if (result.sector) result.sector = turned(*result.sector, -pi);
  return result;
}

const Part laplace{true, true, false, Sector{{0, true}, {pi, false}}};
// Of tanh and coth where their argument's real part is positive: so is theirs.
const Part right_half{true, true, false, Sector{{-pi / 2, false}, {pi / 2, false}}};
const Part without_zeros{true, true, false, std::nullopt};

class Parts {
 public:
  Parts(const Expression& expression, std::span<const double> parameters) : expression_(expression) {
    evaluate_real_nodes(expression, parameters.data(), real_);
    for (std::size_t i = 0; i < expression.nodes.size(); ++i) {
      const Node& node = expression.nodes[i];
      part_.push_back(node.has_s ? of(node) : real_part_of_formula(real_[i]));
    }
  }

  [[nodiscard]] const Part& whole() const { return part_.back(); }

 private:
  [[nodiscard]] const Part& left(const Node& node) const { return part_[static_cast<std::size_t>(node.left)]; }
  [[nodiscard]] const Part& right(const Node& node) const { return part_[static_cast<std::size_t>(node.right)]; }

  [[nodiscard]] Part of(const Node& node) const {
    switch (node.operation) {
      case Operation::laplace:
      case Operation::exact_laplace:
        return laplace;
      case Operation::add:
        return sum(left(node), right(node));
      case Operation::subtract:
        return sum(left(node), negative(right(node)));
      case Operation::multiply:
        return product(left(node), right(node));
      case Operation::divide:
        return product(left(node), reciprocal(right(node)));
      case Operation::negate:
        return negative(left(node));
      case Operation::power:
      case Operation::power_of_s: {
        if (expression_.nodes[static_cast<std::size_t>(node.right)].has_s) return {};
        const double exponent = real_[static_cast<std::size_t>(node.right)];
        return power(node.operation == Operation::power ? left(node) : product(left(node), laplace), exponent);
      }
      case Operation::sqrt:
        return power(left(node), 0.5);
      case Operation::tanh:
      case Operation::coth:
        return left(node).has_positive_real_part() ? right_half : Part{};
      case Operation::sech:
        return left(node).has_positive_real_part() ? without_zeros : Part{};
      case Operation::sinh:
      case Operation::cosh:
        return {left(node).is_analytic, left(node).has_positive_real_part(), false, std::nullopt};
      case Operation::exp:
        return negative(left(node)).has_positive_real_part() ? without_zeros : Part{};
      case Operation::log:
        return {left(node).keeps_off_the_cut(), false, false, std::nullopt};
      case Operation::number:
      case Operation::parameter:
        break;
    }
    return {};
  }

  const Expression& expression_;
  std::vector<double> real_;
  std::vector<Part> part_;
};

}  // namespace

bool is_analytic_in_cut_plane(const Expression& expression, std::span<const double> parameters) {
  return Parts(expression, parameters).whole().is_analytic;
}

}  // namespace frac::detail
