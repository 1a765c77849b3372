// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "expression.hpp"

namespace frac::detail {

/// Appends operations to an expression: equal subexpressions become one node, and powers of multiples of s are
/// recognised.
class ExpressionBuilder {
 public:
  /// Bytes of the formula that a node was read from.
  struct Range {
    std::size_t begin;
    std::size_t end;
  };

  explicit ExpressionBuilder(std::string_view formula);

  [[nodiscard]] int number(double value, Range range);
  [[nodiscard]] int parameter(std::string_view name, Range range);
  [[nodiscard]] int laplace(bool exact, Range range);
  [[nodiscard]] int unary(Operation operation, int operand, Range range);
  [[nodiscard]] int binary(Operation operation, int left, int right, Range range);
  [[nodiscard]] int power(int base, int exponent, Range range);
  [[nodiscard]] int square_root(int operand, Range range);

  [[nodiscard]] const Node& node(int index) const { return expression_.nodes[static_cast<std::size_t>(index)]; }

  /// The expression with `root` as its last node and no node that the root does not use.
  [[nodiscard]] Expression finish(int root) &&;

 private:
  // coefficient s, or coefficient/s when inverse
  struct MultipleOfS {
    int coefficient;
    bool inverse;
  };
  [[nodiscard]] std::optional<MultipleOfS> as_multiple_of_s(int index);
  [[nodiscard]] bool is_number(int index, double value) const;
  int append(Operation operation, int left, int right, double number, int parameter, Range range);

  Expression expression_;
  std::map<std::tuple<Operation, int, int, double, int>, int> known_;
};

}  // namespace frac::detail
