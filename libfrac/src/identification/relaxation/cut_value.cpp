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

Complex CutValue::operator()(double rate) {
  const Complex log_s(std::log(rate), std::numbers::pi);
  for (std::size_t i = 0; i < expression_.nodes.size(); ++i) {
    const Node& node = expression_.nodes[i];
    if (!node.has_s) {
      value_[i] = real_[i];
      continue;
    }
    const auto left = [&] { return value_[static_cast<std::size_t>(node.left)]; };
    const auto right = [&] { return value_[static_cast<std::size_t>(node.right)]; };
    switch (node.operation) {
      case Operation::laplace:
      case Operation::exact_laplace:
        value_[i] = Complex(-rate, 0);
        break;
      case Operation::add:
        value_[i] = left() + right();
        break;
      case Operation::subtract:
        value_[i] = left() - right();
        break;
      case Operation::multiply:
        value_[i] = product(left(), right());
        break;
      case Operation::divide:
        value_[i] = product(left(), reciprocal(right()));
        break;
      case Operation::negate:
        value_[i] = -left();
        break;
      case Operation::power_of_s: {
        const double order = right().real();
        value_[i] = std::pow(std::abs(left().real()), order) * exponential(order * log_s);
        break;
      }
      case Operation::power: {
        const double order = right().real();
        const bool whole = order == std::round(order) && std::abs(order) < 1e6;
        value_[i] = whole ? whole_power(left(), static_cast<int>(order)) : exponential(order * principal_log(left()));
        break;
      }
      case Operation::exp:
        value_[i] = exponential(left());
        break;
      case Operation::sqrt:
        value_[i] = std::sqrt(left());
        break;
      case Operation::tanh:
        value_[i] = hyperbolic_tangent(left()).value;
        break;
      case Operation::coth:
        value_[i] = hyperbolic_cotangent(left()).value;
        break;
      case Operation::sinh:
        value_[i] = hyperbolic_sine(left()).value;
        break;
      case Operation::cosh:
        value_[i] = hyperbolic_cosine(left()).value;
        break;
      case Operation::sech:
        value_[i] = hyperbolic_secant(left()).value;
        break;
      case Operation::log:
        value_[i] = principal_log(left());
        break;
      case Operation::number:
      case Operation::parameter:
        break;  // free of s
    }
  }
  return value_.back();
}

}  // namespace frac::detail
