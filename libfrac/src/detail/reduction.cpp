#include "reduction.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "number_text.hpp"
#include "power_sum.hpp"

namespace frac::detail {
namespace {

constexpr double largest_expanded_power = 100;

RatioOfPowerSums constant(double value) {
  RatioOfPowerSums result{{}, {{1, 0}}};
  if (value != 0) result.numerator.push_back({value, 0});
  return result;
}

RatioOfPowerSums monomial(double coefficient, double order) {
  return {{{coefficient, order}}, {{1, 0}}};
}

// A denominator of one term keeps the coefficient 1, so that a sum over s^m needs no cross multiplication.
RatioOfPowerSums normalised(RatioOfPowerSums ratio) {
  if (ratio.denominator.size() == 1) {
    for (PowerTerm& term : ratio.numerator) term.coefficient /= ratio.denominator[0].coefficient;
    ratio.denominator[0].coefficient = 1;
  }
  return ratio;
}

std::vector<PowerTerm> concatenated(std::vector<PowerTerm> a, const std::vector<PowerTerm>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return collected(std::move(a));
}

// Takes out the power of s that numerator and denominator share after a cross multiplication.
void cancel_common_power(RatioOfPowerSums& ratio) {
  if (ratio.numerator.empty()) return;
  const double common = std::min(ratio.numerator.back().order, ratio.denominator.back().order);
  if (common <= 0) return;
  ratio.numerator = scaled(std::move(ratio.numerator), 1, -common);
  ratio.denominator = scaled(std::move(ratio.denominator), 1, -common);
}

RatioOfPowerSums sum(const RatioOfPowerSums& a, const RatioOfPowerSums& b) {
  if (a.numerator.empty()) return b;
  if (b.numerator.empty()) return a;
  if (a.delay != b.delay) {
    throw std::invalid_argument("its terms have different delays, " + number_text(a.delay) + " s and " +
                                number_text(b.delay) + " s");
  }
  if (a.denominator == b.denominator) {
    return {concatenated(a.numerator, b.numerator), a.denominator, a.delay};
  }
  if (a.denominator.size() == 1 && b.denominator.size() == 1) {
    const double order_a = a.denominator[0].order;
    const double order_b = b.denominator[0].order;
    const double order = std::max(order_a, order_b);
    return {concatenated(scaled(a.numerator, 1, order - order_a), scaled(b.numerator, 1, order - order_b)),
            {{1, order}},
            a.delay};
  }
  RatioOfPowerSums result{concatenated(product(a.numerator, b.denominator), product(b.numerator, a.denominator)),
                          product(a.denominator, b.denominator), a.delay};
  cancel_common_power(result);
  return result;
}

RatioOfPowerSums multiplied(const RatioOfPowerSums& a, const RatioOfPowerSums& b) {
  return normalised({product(a.numerator, b.numerator), product(a.denominator, b.denominator), a.delay + b.delay});
}

RatioOfPowerSums inverse(const RatioOfPowerSums& ratio) {
  if (ratio.numerator.empty()) throw std::invalid_argument("it is a division by zero");
  return normalised({ratio.denominator, ratio.numerator, -ratio.delay});
}

RatioOfPowerSums negated(RatioOfPowerSums ratio) {
  ratio.numerator = scaled(std::move(ratio.numerator), -1, 0);
  return ratio;
}

// (c s)^q
RatioOfPowerSums power_of_s(double coefficient, double order) {
  const double factor = std::pow(coefficient, order);
  if (coefficient < 0 && order != std::nearbyint(order)) {
    throw std::invalid_argument("it is a fractional power of a negative multiple of s");
  }
  if (!std::isfinite(factor)) throw std::invalid_argument("its coefficient is not finite");
  return factor == 0 ? constant(0) : monomial(factor, order);
}

RatioOfPowerSums power(const RatioOfPowerSums& base, double order) {
  if (order == std::nearbyint(order) && std::abs(order) <= largest_expanded_power) {
    const RatioOfPowerSums factor = order < 0 ? inverse(base) : base;
    RatioOfPowerSums result = constant(1);
    for (int i = 0; i < std::abs(static_cast<int>(order)); ++i) result = multiplied(result, factor);
    return result;
  }
  const bool is_one_power = base.numerator.size() == 1 && base.denominator.size() == 1 && base.delay == 0;
  if (!is_one_power) throw std::invalid_argument("it is a power of a sum");
  const double coefficient = base.numerator[0].coefficient;
  const double base_order = base.numerator[0].order - base.denominator[0].order;
  // (c s^p)^q = c^q s^(p q) for principal values only while the angle p pi/2 stays below pi.
  if (!(coefficient > 0 && std::abs(base_order) < 2)) {
    throw std::invalid_argument("its base is no positive multiple of a power of s below 2");
  }
  const double factor = std::pow(coefficient, order);
  if (!(std::isfinite(factor) && factor > 0)) throw std::invalid_argument("its coefficient is not finite");
  return monomial(factor, base_order * order);
}

// exp(constant - delay s)
RatioOfPowerSums exponential(const RatioOfPowerSums& argument) {
  const char* const reason = "its argument is no multiple of s plus a constant";
  if (argument.delay != 0 || argument.denominator.size() != 1 || argument.denominator[0].order != 0) {
    throw std::invalid_argument(reason);
  }
  RatioOfPowerSums result = constant(1);
  for (const PowerTerm& term : argument.numerator) {
    if (term.order == 1) {
      result.delay = -term.coefficient;
    } else if (term.order == 0) {
      result.numerator[0].coefficient = std::exp(term.coefficient);
    } else {
      throw std::invalid_argument(reason);
    }
  }
  return result;
}

RatioOfPowerSums apply(const Node& node, const std::vector<RatioOfPowerSums>& reduced,
                       const std::vector<double>& real_values) {
  const auto left = [&]() -> const RatioOfPowerSums& { return reduced[static_cast<std::size_t>(node.left)]; };
  const auto right = [&]() -> const RatioOfPowerSums& { return reduced[static_cast<std::size_t>(node.right)]; };
  const auto real = [&](int index) { return real_values[static_cast<std::size_t>(index)]; };
  switch (node.operation) {
    case Operation::laplace:
    case Operation::exact_laplace:
      return monomial(1, 1);
    case Operation::add:
      return sum(left(), right());
    case Operation::subtract:
      return sum(left(), negated(right()));
    case Operation::multiply:
      return multiplied(left(), right());
    case Operation::divide:
      return multiplied(left(), inverse(right()));
    case Operation::negate:
      return negated(left());
    case Operation::power:
      return power(left(), real(node.right));
    case Operation::power_of_s:
      return power_of_s(real(node.left), real(node.right));
    case Operation::sqrt:
      return power(left(), 0.5);
    case Operation::exp:
      return exponential(left());
    case Operation::tanh:
    case Operation::coth:
      throw std::invalid_argument("it is a function of s");
    case Operation::number:
    case Operation::parameter:
      break;
  }
  throw std::logic_error("reduce: a number or parameter that holds s");
}

}  // namespace

RatioOfPowerSums reduce(const Expression& expression, std::span<const double> parameters) {
  std::vector<double> real_values;
  evaluate_real_nodes(expression, parameters.data(), real_values);
  std::vector<RatioOfPowerSums> reduced;
  reduced.reserve(expression.nodes.size());
  for (std::size_t i = 0; i < expression.nodes.size(); ++i) {
    const Node& node = expression.nodes[i];
    try {
      if (!node.has_s && !std::isfinite(real_values[i])) throw std::invalid_argument("its value is not finite");
      reduced.push_back(node.has_s ? apply(node, reduced, real_values) : constant(real_values[i]));
    } catch (const std::invalid_argument& reason) {
      throw std::invalid_argument("\"" + expression.formula + "\" is no ratio of sums of powers of s, because of \"" +
                                  std::string(expression.text_of(node)) + "\": " + reason.what());
    }
  }
  return std::move(reduced.back());
}

}  // namespace frac::detail
