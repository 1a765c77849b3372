// SPDX-License-Identifier: BSD-3-Clause
#include "grouped_text.hpp"

#include <vector>

#include "base/number_text.hpp"

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

Text called(const char* function, const Text& argument) {
  return {std::string(function) + "(" + argument.text + ")", Hold::whole};
}

}  // namespace

std::string grouped_text(const Expression& expression) {
  std::vector<Text> texts;
  for (const Node& node : expression.nodes) {
    const auto left = [&]() -> const Text& { return texts[static_cast<std::size_t>(node.left)]; };
    const auto right = [&]() -> const Text& { return texts[static_cast<std::size_t>(node.right)]; };
    Text made;
    switch (node.operation) {
      case Operation::number:
        made = {number_text(node.number), node.number < 0 ? Hold::sign : Hold::whole};
        break;
      case Operation::parameter:
        made = {expression.parameter_names[static_cast<std::size_t>(node.parameter)], Hold::whole};
        break;
      case Operation::laplace:
      case Operation::exact_laplace:
        made = {"s", Hold::whole};
        break;
      case Operation::add:
        made = {left().text + " + " + at_least(Hold::quotient, right()), Hold::sum};
        break;
      case Operation::subtract:
        made = {left().text + " - " + at_least(Hold::quotient, right()), Hold::sum};
        break;
      case Operation::multiply: {
        // A number behind a blank is refused, since "2 3" may be a slip.
        const std::string second = at_least(Hold::product, right());
        const bool is_number = !second.empty() && (second[0] == '.' || (second[0] >= '0' && second[0] <= '9'));
        made = {leading(left()) + (is_number ? " * " : " ") + second, Hold::product};
        break;
      }
      case Operation::divide:
        made = {leading(left()) + "/" + at_least(Hold::power, right()), Hold::quotient};
        break;
      case Operation::negate:
        made = {"-" + at_least(Hold::product, left()), Hold::sign};
        break;
      case Operation::power:
        made = raised(left(), right());
        break;
      case Operation::power_of_s:
        made = left().text == "1" ? raised({"s", Hold::whole}, right())
                                  : raised({at_least(Hold::product, left()) + " s", Hold::product}, right());
        break;
      case Operation::exp:
        made = called("exp", left());
        break;
      case Operation::sqrt:
        made = called("sqrt", left());
        break;
      case Operation::tanh:
        made = called("tanh", left());
        break;
      case Operation::coth:
        made = called("coth", left());
        break;
      case Operation::sinh:
        made = called("sinh", left());
        break;
      case Operation::cosh:
        made = called("cosh", left());
        break;
      case Operation::sech:
        made = called("sech", left());
        break;
      case Operation::log:
        made = called("log", left());
        break;
    }
    texts.push_back(std::move(made));
  }
  return texts.back().text;
}

}  // namespace frac::detail
