// SPDX-License-Identifier: BSD-3-Clause
#include "expression.hpp"

#include <cassert>
#include <cmath>

namespace frac::detail {

double real_operation(Operation operation, double left, double right) {
  switch (operation) {
    case Operation::add:
      return left + right;
    case Operation::subtract:
      return left - right;
    case Operation::multiply:
      return left * right;
    case Operation::divide:
      return left / right;
    case Operation::negate:
      return -left;
    case Operation::power:
      return std::pow(left, right);
    case Operation::exp:
      return std::exp(left);
    case Operation::sqrt:
      return std::sqrt(left);
    case Operation::tanh:
      return std::tanh(left);
    case Operation::coth:
      return 1 / std::tanh(left);
    case Operation::sinh:
      return std::sinh(left);
    case Operation::cosh:
      return std::cosh(left);
    case Operation::sech:
      return 1 / std::cosh(left);
    case Operation::log:
      return std::log(left);
    case Operation::number:
    case Operation::parameter:
    case Operation::laplace:
    case Operation::exact_laplace:
    case Operation::power_of_s:
      break;
  }
  assert(false);
  return 0;
}

std::pair<double, double> real_derivatives(Operation operation, double left, double right, double value,
                                           bool want_right) {
  switch (operation) {
    case Operation::add:
      return {1, 1};
    case Operation::subtract:
      return {1, -1};
    case Operation::multiply:
      return {right, left};
    case Operation::divide:
      return {1 / right, -value / right};
    case Operation::negate:
      return {-1, 0};
    case Operation::power: {
      const double by_base = right == 0 ? 0 : right * std::pow(left, right - 1);
      const double by_exponent = !want_right || value == 0 ? 0 : value * std::log(left);
      return {by_base, by_exponent};
    }
    case Operation::exp:
      return {value, 0};
    case Operation::sqrt:
      return {0.5 / value, 0};
    case Operation::tanh: {
      const double cosh = std::cosh(left);
      return {1 / cosh / cosh, 0};
    }
    case Operation::coth: {
      const double sinh = std::sinh(left);
      return {-1 / sinh / sinh, 0};
    }
    case Operation::sinh:
      return {std::cosh(left), 0};
    case Operation::cosh:
      return {std::sinh(left), 0};
    case Operation::sech:
      return {-value * std::tanh(left), 0};
    case Operation::log:
      return {1 / left, 0};
    case Operation::number:
    case Operation::parameter:
    case Operation::laplace:
    case Operation::exact_laplace:
    case Operation::power_of_s:
      break;
  }
  return {0, 0};
}

void evaluate_real_nodes(const Expression& expression, const double* parameters, std::vector<double>& values) {
  const std::vector<Node>& nodes = expression.nodes;
  values.assign(nodes.size(), 0.0);
  const auto operand = [&](int index) { return index < 0 ? 0.0 : values[static_cast<std::size_t>(index)]; };
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    if (node.has_s) continue;
    if (node.operation == Operation::number) {
      values[i] = node.number;
    } else if (node.operation == Operation::parameter) {
      values[i] = parameters[node.parameter];
    } else {
      values[i] = real_operation(node.operation, operand(node.left), operand(node.right));
    }
  }
}

std::vector<Node> used_nodes(const std::vector<Node>& nodes, int root) {
  std::vector<bool> used(nodes.size(), false);
  used[static_cast<std::size_t>(root)] = true;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    if (!used[i]) continue;
    if (nodes[i].left >= 0) used[static_cast<std::size_t>(nodes[i].left)] = true;
    if (nodes[i].right >= 0) used[static_cast<std::size_t>(nodes[i].right)] = true;
  }
  std::vector<int> new_index(nodes.size(), -1);
  std::vector<Node> kept;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!used[i]) continue;
    new_index[i] = static_cast<int>(kept.size());
    kept.push_back(nodes[i]);
    if (kept.back().left >= 0) kept.back().left = new_index[static_cast<std::size_t>(kept.back().left)];
    if (kept.back().right >= 0) kept.back().right = new_index[static_cast<std::size_t>(kept.back().right)];
  }
  return kept;
}

std::optional<double> literal_value(const std::vector<Node>& nodes, int index) {
  if (index < 0) return 0.0;
  const Node& node = nodes[static_cast<std::size_t>(index)];
  if (node.has_s || node.has_parameter) return std::nullopt;
  if (node.operation == Operation::number) return node.number;
  return real_operation(node.operation, *literal_value(nodes, node.left), *literal_value(nodes, node.right));
}

}  // namespace frac::detail
