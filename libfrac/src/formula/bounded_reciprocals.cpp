// SPDX-License-Identifier: BSD-3-Clause
#include "bounded_reciprocals.hpp"

#include <cmath>
#include <optional>
#include <vector>

namespace frac::detail {
namespace {

bool is_whole(const std::optional<double>& exponent) {
  return exponent && *exponent == std::round(*exponent);
}

class Rewriting {
 public:
  explicit Rewriting(const Expression& given) : given_(given) {
    for (const Node& node : given.nodes) place_.push_back(rewritten(node));
  }

  [[nodiscard]] Expression result() && {
    Expression expression = given_;
    expression.nodes = used_nodes(nodes_, place_.back());
    return expression;
  }

 private:
  /// The places of the operands are known already.
  int rewritten(Node node) {
    if (node.operation == Operation::divide && at(node.right).has_s) {
      int dividend = place(node.left);
      const std::optional<int> divisor = without_reciprocals(node.right, dividend, node);
      return divisor ? append(Operation::divide, dividend, *divisor, node) : dividend;
    }
    node.left = place(node.left);
    node.right = place(node.right);
    nodes_.push_back(node);
    return static_cast<int>(nodes_.size()) - 1;
  }

  /// What is left of a divisor; its factors cosh go to the dividend.
  std::optional<int> without_reciprocals(int divisor, int& dividend, const Node& quotient) {
    const Node& node = at(divisor);
    if (node.has_s && node.operation == Operation::cosh) {
      dividend = append(Operation::multiply, dividend, reciprocal_of(node), quotient);
      return std::nullopt;
    }
    // Where cosh is negative, a root of sech is not the reciprocal of that of cosh.
    if (node.has_s && node.operation == Operation::power && at(node.left).operation == Operation::cosh &&
        is_whole(literal_value(given_.nodes, node.right))) {
      const int power = append(Operation::power, reciprocal_of(at(node.left)), place(node.right), node);
      dividend = append(Operation::multiply, dividend, power, quotient);
      return std::nullopt;
    }
    if (node.operation != Operation::multiply) return place(divisor);
    const std::optional<int> left = without_reciprocals(node.left, dividend, quotient);
    const std::optional<int> right = without_reciprocals(node.right, dividend, quotient);
    if (left == place(node.left) && right == place(node.right)) return place(divisor);
    if (!left || !right) return left ? left : right;
    return append(Operation::multiply, *left, *right, node);
  }

  int reciprocal_of(const Node& cosh) { return append(Operation::sech, place(cosh.left), -1, cosh); }

  /// @param read_from  the node that stands at that place of the formula
  int append(Operation operation, int left, int right, const Node& read_from) {
    const auto has = [&](bool Node::*property) {
      return nodes_[static_cast<std::size_t>(left)].*property ||
             (right >= 0 && nodes_[static_cast<std::size_t>(right)].*property);
    };
    nodes_.push_back(
        {operation, has(&Node::has_s), has(&Node::has_parameter), left, right, 0, -1, read_from.begin, read_from.end});
    return static_cast<int>(nodes_.size()) - 1;
  }

  [[nodiscard]] const Node& at(int index) const { return given_.nodes[static_cast<std::size_t>(index)]; }
  [[nodiscard]] int place(int index) const { return index < 0 ? -1 : place_[static_cast<std::size_t>(index)]; }

  const Expression& given_;
  std::vector<Node> nodes_;
  std::vector<int> place_;  // of each node of the given expression
};

}  // namespace

Expression with_bounded_reciprocals(const Expression& expression) {
  return Rewriting(expression).result();
}

}  // namespace frac::detail
