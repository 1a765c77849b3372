// SPDX-License-Identifier: BSD-3-Clause
#include "grouped_text.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

#include "base/number_text.hpp"
#include "function_names.hpp"

namespace frac::detail {
namespace {

/// How firmly the parts of a text hold together; what holds less than its surroundings need stands in parentheses.
enum class Hold { sum, sign, quotient, product, power, whole };

struct Text {
  std::string text;
  Hold hold;
};

std::string at_least(Hold needed, const Text& part) {
  return part.hold < needed ? "(" + part.text + ")" : part.text;
}

/// The first part of a product or quotient, which may have a sign: it belongs to the whole as well.
std::string leading(const Text& part) {
  return part.hold == Hold::sign ? part.text : at_least(Hold::product, part);
}

Text raised(const Text& base, const Text& exponent) {
  return {at_least(Hold::whole, base) + "^" + at_least(Hold::whole, exponent), Hold::power};
}

Text called(Operation function, const Text& argument) {
  const auto name = std::find_if(std::begin(function_names), std::end(function_names),
                                 [&](const auto& known) { return known.second == function; });
  return {std::string(name->first) + "(" + argument.text + ")", Hold::whole};
}

Text product(const Text& left, const Text& right) {
  // A number behind a blank is refused, since "2 3" may be a slip.
  const std::string second = at_least(Hold::product, right);
  const bool is_number = !second.empty() && (second[0] == '.' || (second[0] >= '0' && second[0] <= '9'));
  return {leading(left) + (is_number ? " * " : " ") + second, Hold::product};
}

/// @param before  the texts of the nodes before it
Text text_of(const Node& node, const Expression& expression, const std::vector<Text>& before) {
  const auto left = [&]() -> const Text& { return before[static_cast<std::size_t>(node.left)]; };
  const auto right = [&]() -> const Text& { return before[static_cast<std::size_t>(node.right)]; };
  switch (node.operation) {
    case Operation::number:
      return {number_text(node.number), node.number < 0 ? Hold::sign : Hold::whole};
    case Operation::parameter:
      return {expression.parameter_names[static_cast<std::size_t>(node.parameter)], Hold::whole};
    case Operation::laplace:
    case Operation::exact_laplace:
      return {"s", Hold::whole};
    case Operation::add:
      return {left().text + " + " + at_least(Hold::quotient, right()), Hold::sum};
    case Operation::subtract:
      return {left().text + " - " + at_least(Hold::quotient, right()), Hold::sum};
    case Operation::multiply:
      return product(left(), right());
    case Operation::divide:
      return {leading(left()) + "/" + at_least(Hold::power, right()), Hold::quotient};
    case Operation::negate:
      return {"-" + at_least(Hold::product, left()), Hold::sign};
    case Operation::power:
      return raised(left(), right());
    case Operation::power_of_s:
      return left().text == "1" ? raised({"s", Hold::whole}, right())
                                : raised({at_least(Hold::product, left()) + " s", Hold::product}, right());
    default:
      return called(node.operation, left());
  }
}

}  // namespace

std::string grouped_text(const Expression& expression) {
  std::vector<Text> texts;
  for (const Node& node : expression.nodes) texts.push_back(text_of(node, expression, texts));
  return texts.back().text;
}

}  // namespace frac::detail
