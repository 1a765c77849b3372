// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace frac::detail {

enum class Operation {
  number,
  parameter,
  laplace,        // s, put into practice as the power s^1
  exact_laplace,  // s inside exp( ): j omega whatever the realisation, so that exp(-L s) is a pure delay
  add,
  subtract,
  multiply,
  divide,
  negate,
  power,       // left^right, left no multiple of s
  power_of_s,  // (left s)^right, left and right free of s
  exp,
  sqrt,
  tanh,
  coth,
  sinh,
  cosh,
  sech,
  log,  // principal value
};

/// One operation of a formula.  Operands stand before the nodes that use them, and equal subexpressions are one node.
struct Node {
  Operation operation;
  bool has_s;
  bool has_parameter;
  int left;                // index of the (first) operand, -1: none
  int right;               // index of the second operand, -1: none
  double number;           // of a number
  int parameter;           // index of a parameter
  std::size_t begin, end;  // bytes of the formula it was read from
};

/// A formula as a list of operations in order of evaluation; the last node is the whole.
struct Expression {
  std::string formula;
  std::vector<std::string> parameter_names;
  std::vector<Node> nodes;

  [[nodiscard]] std::string_view text_of(const Node& node) const {
    return std::string_view(formula).substr(node.begin, node.end - node.begin);
  }
};

/// The operation on real numbers, for nodes free of s.  Not finite where it has no real value.
[[nodiscard]] double real_operation(Operation operation, double left, double right);

/// Its derivatives by the left and by the right operand; the latter is 0 unless wanted.
[[nodiscard]] std::pair<double, double> real_derivatives(Operation operation, double left, double right, double value,
                                                         bool want_right);

/// The value of each node free of s at the given parameters; 0 for the others.
void evaluate_real_nodes(const Expression& expression, const double* parameters, std::vector<double>& values);

/// The nodes that one of them uses, itself as the last.
[[nodiscard]] std::vector<Node> used_nodes(const std::vector<Node>& nodes, int root);

/// Value of a node that holds neither s nor a parameter; empty for any other.
[[nodiscard]] std::optional<double> literal_value(const std::vector<Node>& nodes, int index);

}  // namespace frac::detail
