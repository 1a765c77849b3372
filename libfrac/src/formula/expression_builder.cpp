// SPDX-License-Identifier: BSD-3-Clause
#include "expression_builder.hpp"

#include <algorithm>
#include <utility>

namespace frac::detail {

ExpressionBuilder::ExpressionBuilder(std::string_view formula) {
  expression_.formula = formula;
}

int ExpressionBuilder::append(Operation operation, int left, int right, double number, int parameter, Range range) {
  const auto [place, is_new] =
      known_.try_emplace({operation, left, right, number, parameter}, static_cast<int>(expression_.nodes.size()));
  if (!is_new) return place->second;
  const auto any_operand = [&](bool Node::*flag) {
    return (left >= 0 && node(left).*flag) || (right >= 0 && node(right).*flag);
  };
  const bool is_s =
      operation == Operation::laplace || operation == Operation::exact_laplace || operation == Operation::power_of_s;
  const bool has_s = is_s || any_operand(&Node::has_s);
  const bool has_parameter = operation == Operation::parameter || any_operand(&Node::has_parameter);
  expression_.nodes.push_back(
      {operation, has_s, has_parameter, left, right, number, parameter, range.begin, range.end});
  return place->second;
}

int ExpressionBuilder::number(double value, Range range) {
  return append(Operation::number, -1, -1, value, -1, range);
}

int ExpressionBuilder::parameter(std::string_view name, Range range) {
  auto& names = expression_.parameter_names;
  const auto place = std::find(names.begin(), names.end(), name);
  const auto index = static_cast<int>(place - names.begin());
  if (place == names.end()) names.emplace_back(name);
  return append(Operation::parameter, -1, -1, 0, index, range);
}

int ExpressionBuilder::laplace(bool exact, Range range) {
  return append(exact ? Operation::exact_laplace : Operation::laplace, -1, -1, 0, -1, range);
}

int ExpressionBuilder::unary(Operation operation, int operand, Range range) {
  return append(operation, operand, -1, 0, -1, range);
}

int ExpressionBuilder::binary(Operation operation, int left, int right, Range range) {
  return append(operation, left, right, 0, -1, range);
}

bool ExpressionBuilder::is_number(int index, double value) const {
  return node(index).operation == Operation::number && node(index).number == value;
}

std::optional<ExpressionBuilder::MultipleOfS> ExpressionBuilder::as_multiple_of_s(int index) {
  const Node at = node(index);
  const Range range{at.begin, at.end};
  switch (at.operation) {
    case Operation::laplace:
    case Operation::exact_laplace:
      return MultipleOfS{number(1, range), false};
    case Operation::negate: {
      auto inner = as_multiple_of_s(at.left);
      if (inner) inner->coefficient = unary(Operation::negate, inner->coefficient, range);
      return inner;
    }
    case Operation::multiply: {
      if (node(at.left).has_s == node(at.right).has_s) return std::nullopt;
      const int factor = node(at.left).has_s ? at.right : at.left;
      auto inner = as_multiple_of_s(node(at.left).has_s ? at.left : at.right);
      if (!inner) return std::nullopt;
      inner->coefficient =
          is_number(inner->coefficient, 1) ? factor : binary(Operation::multiply, factor, inner->coefficient, range);
      return inner;
    }
    case Operation::divide: {
      if (node(at.left).has_s == node(at.right).has_s) return std::nullopt;
      const bool s_below = node(at.right).has_s;
      auto inner = as_multiple_of_s(s_below ? at.right : at.left);
      if (!inner) return std::nullopt;
      if (s_below) {
        inner->inverse = !inner->inverse;
        inner->coefficient =
            is_number(inner->coefficient, 1) ? at.left : binary(Operation::divide, at.left, inner->coefficient, range);
      } else {
        inner->coefficient = binary(Operation::divide, inner->coefficient, at.right, range);
      }
      return inner;
    }
    default:
      return std::nullopt;
  }
}

int ExpressionBuilder::power(int base, int exponent, Range range) {
  if (!node(base).has_s) return binary(Operation::power, base, exponent, range);
  if (is_number(exponent, 1)) return base;
  const auto multiple = as_multiple_of_s(base);
  if (!multiple) return binary(Operation::power, base, exponent, range);
  if (!multiple->inverse) return append(Operation::power_of_s, multiple->coefficient, exponent, 0, -1, range);
  // (c/s)^q = (s/c)^-q holds for principal values, because s = j omega is no negative number.
  const int coefficient = is_number(multiple->coefficient, 1)
                              ? multiple->coefficient
                              : binary(Operation::divide, number(1, range), multiple->coefficient, range);
  return append(Operation::power_of_s, coefficient, unary(Operation::negate, exponent, range), 0, -1, range);
}

int ExpressionBuilder::square_root(int operand, Range range) {
  if (!node(operand).has_s || !as_multiple_of_s(operand)) return unary(Operation::sqrt, operand, range);
  return power(operand, number(0.5, range), range);
}

Expression ExpressionBuilder::finish(int root) && {
  expression_.nodes = used_nodes(expression_.nodes, root);
  return std::move(expression_);
}

}  // namespace frac::detail
