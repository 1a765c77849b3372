// SPDX-License-Identifier: BSD-3-Clause
#include "cut_value.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "special/complex_functions.hpp"
#include "special/exact_power.hpp"

namespace frac::detail {

using Complex = std::complex<double>;

namespace {

/// Hands the operation of a node that depends on s to `use`, as a function of the operands and of the rate.
/// @param order  value of the right operand, where that is free of s
template <class Use>
auto with_operation(const Node& node, double order, const Use& use) {
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
      return use([order, turns = quarter_turns(2 * order)](Complex left, Complex, double rate) {
        return real_power(std::abs(left.real()) * rate, order) * turns;
      });
    case Operation::power:
      return use([order](Complex left, Complex, double) {
        if (order == 0.5) return std::sqrt(left);
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

Complex CutValue::of(int wanted, double rate) {
  const auto operand = [&](int node) { return node < 0 ? Complex() : value_[static_cast<std::size_t>(node)]; };
  const auto last = static_cast<std::size_t>(wanted);
  for (std::size_t i = 0; i <= last; ++i) {
    const Node& node = expression_.nodes[i];
    value_[i] = !node.has_s ? real_[i] : with_operation(node, operand(node.right).real(), [&](auto operation) {
      return operation(operand(node.left), operand(node.right), rate);
    });
  }
  return value_[last];
}

namespace {

/// One operation at some rates.
/// @param left,right  its operands there; those that it has not are not looked at
void evaluate(const Node& node, double real, std::span<const double> rates, const Complex* left, const Complex* right,
              Complex* result) {
  if (!node.has_s) {
    std::fill_n(result, rates.size(), real);
    return;
  }
  with_operation(node, right ? right->real() : 0, [&](auto operation) {
    const Complex none;
    for (std::size_t k = 0; k < rates.size(); ++k)
      result[k] = operation(left ? left[k] : none, right ? right[k] : none, rates[k]);
    return 0;
  });
}

}  // namespace

CutValues::CutValues(const Expression& expression, std::span<const double> parameters, std::vector<double> rates)
    : expression_(expression),
      parameters_(parameters.begin(), parameters.end()),
      rates_(std::move(rates)),
      value_(expression.nodes.size(), std::vector<Complex>(rates_.size())) {
  evaluate_real_nodes(expression, parameters.data(), real_);
  const auto at = [&](int node) { return node < 0 ? nullptr : value_[static_cast<std::size_t>(node)].data(); };
  for (std::size_t i = 0; i < value_.size(); ++i) {
    const Node& node = expression.nodes[i];
    evaluate(node, real_[i], rates_, at(node.left), at(node.right), value_[i].data());
  }
}

std::vector<Complex> CutValues::moved(std::size_t parameter, double to) const {
  std::vector<double> parameters = parameters_, real;
  parameters[parameter] = to;
  evaluate_real_nodes(expression_, parameters.data(), real);
  std::vector<bool> moves;
  const auto operand_moves = [&](int node) { return node >= 0 && moves[static_cast<std::size_t>(node)]; };
  for (std::size_t i = 0; i < value_.size(); ++i) {
    const Node& node = expression_.nodes[i];
    moves.push_back(node.has_s ? operand_moves(node.left) || operand_moves(node.right) : real[i] != real_[i]);
  }
  std::vector<Complex> result = value_.back();
  if (!moves.back()) return result;
  // In pieces that stay in the cache of the processor.
  constexpr std::size_t piece = 256;
  std::vector<std::array<Complex, piece>> changed(value_.size());
  for (std::size_t start = 0; start < rates_.size(); start += piece) {
    const auto rates = std::span(rates_).subspan(start, std::min(piece, rates_.size() - start));
    const auto at = [&](int node) -> const Complex* {
      if (node < 0) return nullptr;
      const auto i = static_cast<std::size_t>(node);
      return moves[i] ? changed[i].data() : value_[i].data() + start;
    };
    for (std::size_t i = 0; i < value_.size(); ++i) {
      const Node& node = expression_.nodes[i];
      if (moves[i]) evaluate(node, real[i], rates, at(node.left), at(node.right), changed[i].data());
    }
    std::copy_n(changed.back().begin(), rates.size(), result.begin() + static_cast<std::ptrdiff_t>(start));
  }
  return result;
}

}  // namespace frac::detail
