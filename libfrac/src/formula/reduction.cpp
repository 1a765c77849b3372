// SPDX-License-Identifier: BSD-3-Clause
#include "reduction.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "frac/no_ratio.hpp"
#include "power_algebra.hpp"

namespace frac::detail {
namespace {

Slope combined(double a, const Slope& x, double b, const Slope& y) {
  Slope result(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) result[i] = a * x[i] + b * y[i];
  return result;
}

// x = a x + b y
void combine(double a, Slope& x, double b, const Slope& y) {
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = a * x[i] + b * y[i];
}

bool is_zero(const Slope& slope) {
  return std::all_of(slope.begin(), slope.end(), [](double each) { return each == 0; });
}

}  // namespace

void add_to(SensitiveTerm& sum, const SensitiveTerm& term) {
  sum.coefficient = sum_or_nothing(sum.coefficient, term.coefficient);
  combine(1, sum.by_coefficient, 1, term.by_coefficient);
  combine(1, sum.by_order, 1, term.by_order);
}

SensitiveTerm times(const SensitiveTerm& a, const SensitiveTerm& b) {
  return {a.coefficient * b.coefficient, a.order + b.order,
          combined(b.coefficient, a.by_coefficient, a.coefficient, b.by_coefficient),
          combined(b.coefficient, a.by_order, a.coefficient, b.by_order)};
}

bool is_nothing(const SensitiveTerm& term) {
  return term.coefficient == 0 && is_zero(term.by_coefficient) && is_zero(term.by_order);
}

namespace {

// A number free of s.
struct Real {
  double value;
  Slope slope;
};

void multiply(Slope& slope, double factor) {
  for (double& each : slope) each *= factor;
}

bool is_zero(const SensitiveSum& sum) {
  return std::all_of(sum.begin(), sum.end(), [](const SensitiveTerm& term) { return term.coefficient == 0; });
}

// Times s^order.
SensitiveSum shifted(SensitiveSum terms, double order, const Slope& order_slope) {
  for (SensitiveTerm& term : terms) {
    term.order += order;
    combine(1, term.by_order, term.coefficient, order_slope);
  }
  return terms;
}

RatioOfPowerSums constant(Real value) {
  const Slope none(value.slope.size(), 0.0);
  RatioOfPowerSums result{{}, {{1, 0, none, none}}, 0, none};
  if (value.value != 0 || !is_zero(value.slope)) {
    result.numerator.push_back({value.value, 0, std::move(value.slope), none});
  }
  return result;
}

RatioOfPowerSums monomial(Real coefficient, double order, const Slope& order_slope) {
  RatioOfPowerSums result = constant(std::move(coefficient));
  result.numerator = shifted(std::move(result.numerator), order, order_slope);
  return result;
}

SensitiveSum divided(SensitiveSum sum, const Real& divisor) {
  for (SensitiveTerm& term : sum) {
    term.coefficient /= divisor.value;
    combine(1 / divisor.value, term.by_coefficient, -term.coefficient / divisor.value, divisor.slope);
    multiply(term.by_order, 1 / divisor.value);
  }
  return sum;
}

// A denominator of one term keeps the coefficient 1, so that a sum over s^m needs no cross multiplication.
RatioOfPowerSums normalised(RatioOfPowerSums ratio) {
  SensitiveTerm& bottom = ratio.denominator.front();
  if (ratio.denominator.size() > 1 || (bottom.coefficient == 1 && is_zero(bottom.by_coefficient))) return ratio;
  const Real divisor{bottom.coefficient, bottom.by_coefficient};
  ratio.numerator = divided(std::move(ratio.numerator), divisor);
  multiply(bottom.by_order, 1 / divisor.value);
  bottom.coefficient = 1;
  std::fill(bottom.by_coefficient.begin(), bottom.by_coefficient.end(), 0.0);
  return ratio;
}

SensitiveSum concatenated(SensitiveSum a, const SensitiveSum& b) {
  a.insert(a.end(), b.begin(), b.end());
  return collected_terms(std::move(a));
}

// Takes out the power of s that numerator and denominator share after a cross multiplication.
void cancel_common_power(RatioOfPowerSums& ratio) {
  if (ratio.numerator.empty()) return;
  const double common = std::min(ratio.numerator.back().order, ratio.denominator.back().order);
  if (common <= 0) return;
  const Slope none(ratio.delay_slope.size(), 0.0);
  ratio.numerator = shifted(std::move(ratio.numerator), -common, none);
  ratio.denominator = shifted(std::move(ratio.denominator), -common, none);
}

RatioOfPowerSums sum(const RatioOfPowerSums& a, const RatioOfPowerSums& b) {
  if (a.numerator.empty()) return b;
  if (b.numerator.empty()) return a;
  if (a.delay != b.delay) {
    const auto [shorter, longer] = std::minmax(a.delay, b.delay);
    throw std::invalid_argument("its terms have different delays, " + number_text(shorter) + " s and " +
                                number_text(longer) + " s");
  }
  if (a.denominator == b.denominator) {
    return {concatenated(a.numerator, b.numerator), a.denominator, a.delay, a.delay_slope};
  }
  if (a.denominator.size() == 1 && b.denominator.size() == 1) {
    const SensitiveTerm& higher =
        a.denominator[0].order >= b.denominator[0].order ? a.denominator[0] : b.denominator[0];
    const auto raised = [&](const RatioOfPowerSums& ratio) {
      const SensitiveTerm& own = ratio.denominator[0];
      return shifted(ratio.numerator, higher.order - own.order, combined(1, higher.by_order, -1, own.by_order));
    };
    return {concatenated(raised(a), raised(b)), {higher}, a.delay, a.delay_slope};
  }
  RatioOfPowerSums result{
      concatenated(product_of_terms(a.numerator, b.denominator), product_of_terms(b.numerator, a.denominator)),
      product_of_terms(a.denominator, b.denominator), a.delay, a.delay_slope};
  cancel_common_power(result);
  return result;
}

bool is_one(const SensitiveSum& sum) {
  return sum.size() == 1 && sum[0].coefficient == 1 && sum[0].order == 0 && is_zero(sum[0].by_coefficient) &&
         is_zero(sum[0].by_order);
}

SensitiveSum product(const SensitiveSum& a, const SensitiveSum& b) {
  return is_one(a) ? b : is_one(b) ? a : product_of_terms(a, b);
}

RatioOfPowerSums multiplied(const RatioOfPowerSums& a, const RatioOfPowerSums& b) {
  return normalised({product(a.numerator, b.numerator), product(a.denominator, b.denominator), a.delay + b.delay,
                     combined(1, a.delay_slope, 1, b.delay_slope)});
}

// Numbers are taken in as such: a ratio made of each would need memory for all of its lists.

SensitiveSum scaled(SensitiveSum sum, const Real& factor) {
  for (SensitiveTerm& term : sum) {
    combine(factor.value, term.by_coefficient, term.coefficient, factor.slope);
    multiply(term.by_order, factor.value);
    term.coefficient *= factor.value;
  }
  std::erase_if(sum, [](const SensitiveTerm& term) { return is_nothing(term); });
  return sum;
}

RatioOfPowerSums multiplied(RatioOfPowerSums ratio, const Real& factor) {
  ratio.numerator = scaled(std::move(ratio.numerator), factor);
  return ratio;
}

RatioOfPowerSums divided(RatioOfPowerSums ratio, const Real& divisor) {
  if (divisor.value == 0) throw std::invalid_argument("it is a division by zero");
  ratio.numerator = divided(std::move(ratio.numerator), divisor);
  return ratio;
}

RatioOfPowerSums sum(const RatioOfPowerSums& a, const Real& b) {
  if (a.numerator.empty() || a.delay != 0) return sum(a, constant(b));
  RatioOfPowerSums result{concatenated(a.numerator, scaled(a.denominator, b)), a.denominator, a.delay, a.delay_slope};
  if (a.denominator.size() > 1) cancel_common_power(result);
  return result;
}

Real negated(Real real) {
  real.value = -real.value;
  multiply(real.slope, -1);
  return real;
}

RatioOfPowerSums inverse(const RatioOfPowerSums& ratio) {
  if (is_zero(ratio.numerator)) throw std::invalid_argument("it is a division by zero");
  return normalised(
      {ratio.denominator, ratio.numerator, -ratio.delay, combined(-1, ratio.delay_slope, 0, ratio.delay_slope)});
}

RatioOfPowerSums negated(RatioOfPowerSums ratio) {
  for (SensitiveTerm& term : ratio.numerator) {
    term.coefficient = -term.coefficient;
    multiply(term.by_coefficient, -1);
    multiply(term.by_order, -1);
  }
  return ratio;
}

// c^q
Real real_power(const Real& base, const Real& order) {
  const double value = std::pow(base.value, order.value);
  const bool order_moves = !is_zero(order.slope);
  const auto [by_base, by_order] = real_derivatives(Operation::power, base.value, order.value, value, order_moves);
  return {value, combined(by_base, base.slope, order_moves ? by_order : 0, order.slope)};
}

// (c s)^q
RatioOfPowerSums power_of_s(const Real& coefficient, const Real& order) {
  Real factor = real_power(coefficient, order);
  if (coefficient.value < 0 && order.value != std::nearbyint(order.value)) {
    throw std::invalid_argument("it is a fractional power of a negative multiple of s");
  }
  if (!std::isfinite(factor.value)) throw std::invalid_argument("its coefficient is not finite");
  return monomial(std::move(factor), order.value, order.slope);
}

RatioOfPowerSums power(const RatioOfPowerSums& base, const Real& order) {
  const bool is_one_power = base.numerator.size() == 1 && base.denominator.size() == 1 && base.delay == 0;
  const bool order_moves = !is_zero(order.slope);
  if (order.value == std::nearbyint(order.value) && std::abs(order.value) <= largest_expanded_power &&
      !(is_one_power && order_moves)) {
    if (order_moves) throw std::invalid_argument("its order is a parameter and its base a sum");
    const RatioOfPowerSums factor = order.value < 0 ? inverse(base) : base;
    RatioOfPowerSums result = constant({1, Slope(order.slope.size(), 0.0)});
    for (int i = 0; i < std::abs(static_cast<int>(order.value)); ++i) result = multiplied(result, factor);
    return result;
  }
  if (!is_one_power) throw std::invalid_argument("it is a power of a sum");
  const SensitiveTerm& top = base.numerator[0];
  const double base_order = top.order - base.denominator[0].order;
  // (c s^p)^q = c^q s^(p q) for principal values only while the angle p pi/2 stays below pi.
  if (!(top.coefficient > 0 && std::abs(base_order) < 2)) {
    throw std::invalid_argument("its base is no positive multiple of a power of s below 2");
  }
  Real factor = real_power({top.coefficient, top.by_coefficient}, order);
  if (!(std::isfinite(factor.value) && factor.value > 0)) throw std::invalid_argument("its coefficient is not finite");
  const Slope base_order_slope = combined(1 / top.coefficient, top.by_order, -1, base.denominator[0].by_order);
  return monomial(std::move(factor), base_order * order.value,
                  combined(order.value, base_order_slope, base_order, order.slope));
}

// exp(constant - delay s)
RatioOfPowerSums exponential(const RatioOfPowerSums& argument) {
  const char* const reason = "its argument is no multiple of s plus a constant";
  if (argument.delay != 0 || argument.denominator.size() != 1 || argument.denominator[0].order != 0) {
    throw std::invalid_argument(reason);
  }
  RatioOfPowerSums result = constant({1, Slope(argument.delay_slope.size(), 0.0)});
  for (const SensitiveTerm& term : argument.numerator) {
    if (!is_zero(term.by_order)) throw std::invalid_argument(reason);
    if (term.order == 1) {
      result.delay = -term.coefficient;
      result.delay_slope = combined(-1, term.by_coefficient, 0, term.by_coefficient);
    } else if (term.order == 0) {
      SensitiveTerm& factor = result.numerator[0];
      factor.coefficient = std::exp(term.coefficient);
      factor.by_coefficient = combined(factor.coefficient, term.by_coefficient, 0, term.by_coefficient);
    } else {
      throw std::invalid_argument(reason);
    }
  }
  return result;
}

bool is_arithmetic(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract || operation == Operation::multiply ||
         operation == Operation::divide;
}

// Operands free of s are in real_values; those of other operations than sums, products and quotients in `reduced` too.
RatioOfPowerSums apply(const std::vector<Node>& nodes, const Node& node, const std::vector<RatioOfPowerSums>& reduced,
                       const std::vector<Real>& real_values, std::size_t sensitive_count) {
  const auto has_s = [&](int index) { return nodes[static_cast<std::size_t>(index)].has_s; };
  const auto left = [&]() -> const RatioOfPowerSums& { return reduced[static_cast<std::size_t>(node.left)]; };
  const auto right = [&]() -> const RatioOfPowerSums& { return reduced[static_cast<std::size_t>(node.right)]; };
  const auto real = [&](int index) -> const Real& { return real_values[static_cast<std::size_t>(index)]; };
  const Slope none(sensitive_count, 0.0);
  switch (node.operation) {
    case Operation::laplace:
    case Operation::exact_laplace:
      return monomial({1, none}, 1, none);
    case Operation::add:
      if (!has_s(node.right)) return sum(left(), real(node.right));
      return has_s(node.left) ? sum(left(), right()) : sum(right(), real(node.left));
    case Operation::subtract:
      if (!has_s(node.right)) return sum(left(), negated(real(node.right)));
      return has_s(node.left) ? sum(left(), negated(right())) : sum(negated(right()), real(node.left));
    case Operation::multiply:
      if (!has_s(node.right)) return multiplied(left(), real(node.right));
      return has_s(node.left) ? multiplied(left(), right()) : multiplied(right(), real(node.left));
    case Operation::divide:
      if (!has_s(node.right)) return divided(left(), real(node.right));
      return has_s(node.left) ? multiplied(left(), inverse(right())) : multiplied(inverse(right()), real(node.left));
    case Operation::negate:
      return negated(left());
    case Operation::power:
      return power(left(), real(node.right));
    case Operation::power_of_s:
      return power_of_s(real(node.left), real(node.right));
    case Operation::sqrt:
      return power(left(), {0.5, none});
    case Operation::exp:
      return exponential(left());
    default:
      throw std::invalid_argument("it is a function of s");
  }
}

// Nodes free of s, with their derivatives by the first `sensitive_count` parameters.
std::vector<Real> real_nodes(const Expression& expression, std::span<const double> parameters,
                             std::size_t sensitive_count) {
  std::vector<double> values;
  evaluate_real_nodes(expression, parameters.data(), values);
  std::vector<Real> result;
  result.reserve(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Node& node = expression.nodes[i];
    Real real{values[i], Slope(sensitive_count, 0.0)};
    if (!node.has_s && node.has_parameter && sensitive_count > 0) {
      if (node.operation == Operation::parameter) {
        real.slope[static_cast<std::size_t>(node.parameter)] = 1;
      } else {
        const Real& left = result[static_cast<std::size_t>(node.left)];
        const Real& right = node.right < 0 ? left : result[static_cast<std::size_t>(node.right)];
        const bool right_moves = node.right >= 0 && !is_zero(right.slope);
        const auto [by_left, by_right] =
            real_derivatives(node.operation, left.value, right.value, real.value, right_moves);
        real.slope = combined(by_left, left.slope, right_moves ? by_right : 0, right.slope);
      }
    }
    result.push_back(std::move(real));
  }
  return result;
}

}  // namespace

RatioOfPowerSums reduce(const Expression& expression, std::span<const double> parameters, Sensitivity sensitivity) {
  const std::size_t sensitive_count = sensitivity == Sensitivity::all ? parameters.size() : 0;
  const std::vector<Real> real_values = real_nodes(expression, parameters, sensitive_count);
  std::vector<RatioOfPowerSums> reduced(expression.nodes.size());
  const auto complete = [&](int operand) {
    if (operand < 0 || expression.nodes[static_cast<std::size_t>(operand)].has_s) return;
    reduced[static_cast<std::size_t>(operand)] = constant(real_values[static_cast<std::size_t>(operand)]);
  };
  for (std::size_t i = 0; i < expression.nodes.size(); ++i) {
    const Node& node = expression.nodes[i];
    try {
      if (!node.has_s) {
        if (!std::isfinite(real_values[i].value)) throw std::invalid_argument("its value is not finite");
        continue;
      }
      if (!is_arithmetic(node.operation) && node.operation != Operation::power_of_s) complete(node.left);
      reduced[i] = apply(expression.nodes, node, reduced, real_values, sensitive_count);
    } catch (const std::invalid_argument& reason) {
      throw NoRatio("\"" + expression.formula + "\" is no ratio of sums of powers of s, because of \"" +
                    std::string(expression.text_of(node)) + "\": " + reason.what());
    }
  }
  complete(static_cast<int>(expression.nodes.size()) - 1);
  return std::move(reduced.back());
}

std::vector<PowerTerm> plain_terms(const SensitiveSum& sum) {
  std::vector<PowerTerm> terms;
  for (const SensitiveTerm& term : sum) {
    if (term.coefficient != 0) terms.push_back({term.coefficient, term.order});
  }
  return terms;
}

}  // namespace frac::detail
