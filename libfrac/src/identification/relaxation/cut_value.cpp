// SPDX-License-Identifier: BSD-3-Clause
#include "cut_value.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "special/complex_functions.hpp"

namespace frac::detail {

using Complex = std::complex<double>;

namespace {

/// Hands the operation of a node that depends on s to `use`, as a function of the operands and of the rate.
template <class Use>
auto with_operation(const Node& node, const Use& use) {
  switch (node.operation) {
    case Operation::add:
      return use([](Complex left, Complex right, double) { return left + right; });
    case Operation::subtract:
      return use([](Complex left, Complex right, double) { return left - right; });
    case Operation::multiply:
      return use([](Complex left, Complex right, double) { return product(left, right); });
    case Operation::divide:
      return use([](Complex left, Complex right, double) { return product(left, reciprocal(right)); });
    case Operation::negate:
      return use([](Complex left, Complex, double) { return -left; });
    case Operation::power_of_s:
      return use([](Complex left, Complex right, double rate) {
        const double order = right.real();
        return std::pow(std::abs(left.real()), order) * exponential(order * Complex(std::log(rate), std::numbers::pi));
      });
    case Operation::power:
      return use([](Complex left, Complex right, double) {
        const double order = right.real();
        const bool whole = order == std::round(order) && std::abs(order) < 1e6;
        return whole ? whole_power(left, static_cast<int>(order)) : exponential(order * principal_log(left));
      });
    case Operation::exp:
      return use([](Complex left, Complex, double) { return exponential(left); });
    case Operation::sqrt:
      return use([](Complex left, Complex, double) { return std::sqrt(left); });
    case Operation::tanh:
      return use([](Complex left, Complex, double) { return hyperbolic_tangent(left).value; });
    case Operation::coth:
      return use([](Complex left, Complex, double) { return hyperbolic_cotangent(left).value; });
    case Operation::sinh:
      return use([](Complex left, Complex, double) { return hyperbolic_sine(left).value; });
    case Operation::cosh:
      return use([](Complex left, Complex, double) { return hyperbolic_cosine(left).value; });
    case Operation::sech:
      return use([](Complex left, Complex, double) { return hyperbolic_secant(left).value; });
    case Operation::log:
      return use([](Complex left, Complex, double) { return principal_log(left); });
    case Operation::laplace:
    case Operation::exact_laplace:
    case Operation::number:  // the last two are free of s, so that nobody asks
    case Operation::parameter:
      break;
  }
  return use([](Complex, Complex, double rate) { return Complex(-rate, 0); });
}

}  // namespace

CutValue::CutValue(const Expression& expression, std::span<const double> parameters)
    : expression_(expression), value_(expression.nodes.size()) {
  evaluate_real_nodes(expression, parameters.data(), real_);
}

Complex CutValue::operator()(double rate) {
  const auto operand = [&](int node) { return node < 0 ? Complex() : value_[static_cast<std::size_t>(node)]; };
  for (std::size_t i = 0; i < expression_.nodes.size(); ++i) {
    const Node& node = expression_.nodes[i];
    value_[i] = !node.has_s ? real_[i] : with_operation(node, [&](auto operation) {
      return operation(operand(node.left), operand(node.right), rate);
    });
  }
  return value_.back();
}

namespace {

using NodeValues = std::vector<Complex>;

/// @param of  the values of an operand
template <class Of>
NodeValues at_all_rates(const Node& node, double real, const std::vector<double>& rates, const Of& of) {
  NodeValues result(rates.size(), real);
  if (!node.has_s) return result;
  // An operand that is not there is not looked at.
  const Complex* left = node.left < 0 ? result.data() : of(node.left).data();
  const Complex* right = node.right < 0 ? result.data() : of(node.right).data();
  return with_operation(node, [&](auto operation) {
    for (std::size_t k = 0; k < rates.size(); ++k) result[k] = operation(left[k], right[k], rates[k]);
    return std::move(result);
  });
}

}  // namespace

CutValues::CutValues(const Expression& expression, std::span<const double> parameters, std::vector<double> rates)
    : expression_(expression), parameters_(parameters.begin(), parameters.end()), rates_(std::move(rates)) {
  evaluate_real_nodes(expression, parameters.data(), real_);
  for (std::size_t i = 0; i < expression.nodes.size(); ++i)
    value_.push_back(at_all_rates(expression.nodes[i], real_[i], rates_, [&](int node) -> const NodeValues& {
      return value_[static_cast<std::size_t>(node)];
    }));
}

NodeValues CutValues::moved(std::size_t parameter, double to) const {
  std::vector<double> parameters = parameters_, real;
  parameters[parameter] = to;
  evaluate_real_nodes(expression_, parameters.data(), real);
  std::vector<NodeValues> changed(value_.size());  // empty where a node stays
  const auto has_changed = [&](int node) { return node >= 0 && !changed[static_cast<std::size_t>(node)].empty(); };
  const auto of = [&](int node) -> const NodeValues& {
    return (has_changed(node) ? changed : value_)[static_cast<std::size_t>(node)];
  };
  for (std::size_t i = 0; i < value_.size(); ++i) {
    const Node& node = expression_.nodes[i];
    const bool moves = node.has_s ? has_changed(node.left) || has_changed(node.right) : real[i] != real_[i];
    if (moves) changed[i] = at_all_rates(node, real[i], rates_, of);
  }
  return of(static_cast<int>(value_.size()) - 1);
}

}  // namespace frac::detail
