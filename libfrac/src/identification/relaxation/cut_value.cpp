// SPDX-License-Identifier: BSD-3-Clause
#include "cut_value.hpp"

#include <cmath>
#include <numbers>

#include "special/complex_functions.hpp"

namespace frac::detail {

using Complex = std::complex<double>;

CutValue::CutValue(const Expression& expression, std::span<const double> parameters)
    : expression_(expression), value_(expression.nodes.size()) {
  evaluate_real_nodes(expression, parameters.data(), real_);
}

Complex CutValue::of(const Node& node, double rate) const {
  const auto left = [&] { return value_[static_cast<std::size_t>(node.left)]; };
  const auto right = [&] { return value_[static_cast<std::size_t>(node.right)]; };
  switch (node.operation) {
    case Operation::laplace:
    case Operation::exact_laplace:
      return Complex(-rate, 0);
    case Operation::add:
      return left() + right();
    case Operation::subtract:
      return left() - right();
    case Operation::multiply:
      return product(left(), right());
    case Operation::divide:
      return product(left(), reciprocal(right()));
    case Operation::negate:
      return -left();
    case Operation::power_of_s: {
      const double order = right().real();
      const Complex log_s(std::log(rate), std::numbers::pi);
      return std::pow(std::abs(left().real()), order) * exponential(order * log_s);
    }
    case Operation::power: {
      const double order = right().real();
      const bool whole = order == std::round(order) && std::abs(order) < 1e6;
      return whole ? whole_power(left(), static_cast<int>(order)) : exponential(order * principal_log(left()));
    }
    case Operation::exp:
      return exponential(left());
    case Operation::sqrt:
      return std::sqrt(left());
    case Operation::tanh:
      return hyperbolic_tangent(left()).value;
    case Operation::coth:
      return hyperbolic_cotangent(left()).value;
    case Operation::sinh:
      return hyperbolic_sine(left()).value;
    case Operation::cosh:
      return hyperbolic_cosine(left()).value;
    case Operation::sech:
      return hyperbolic_secant(left()).value;
    case Operation::log:
      return principal_log(left());
    case Operation::number:
    case Operation::parameter:
      break;  // free of s, so that nobody asks
  }
  return {};
}

Complex CutValue::operator()(double rate) {
  for (std::size_t i = 0; i < expression_.nodes.size(); ++i) {
    const Node& node = expression_.nodes[i];
    value_[i] = node.has_s ? of(node, rate) : Complex(real_[i]);
  }
  return value_.back();
}

}  // namespace frac::detail
