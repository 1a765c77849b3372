// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_roles.hpp"

#include <cstddef>

namespace frac::detail {
namespace {

// In what surroundings a node occurs; one that occurs several times collects all.
struct Surroundings {
  bool in_sum = false;
  bool in_exponent = false;
  bool linear_in_exp = false;    // a part of the argument of exp( ) that s enters without a power
  bool factor_of_delay = false;  // multiplies such an s
  bool in_divisor = false;
  bool keeps_sign = false;  // part of a sum of several terms in a divisor, of a base or of an argument
};

bool is_power(Operation operation) {
  return operation == Operation::power || operation == Operation::power_of_s;
}
bool is_sum(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract;
}

// Whether each node is a multiple of s by something free of s, or a sum of such.
std::vector<bool> linear_in_s(const std::vector<Node>& nodes) {
  std::vector<bool> linear(nodes.size(), false);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    const auto is_linear = [&](int index) { return linear[static_cast<std::size_t>(index)]; };
    const auto is_free_of_s = [&](int index) { return !nodes[static_cast<std::size_t>(index)].has_s; };
    switch (node.operation) {
      case Operation::laplace:
      case Operation::exact_laplace:
        linear[i] = true;
        break;
      case Operation::negate:
        linear[i] = is_linear(node.left);
        break;
      case Operation::add:
      case Operation::subtract:
        linear[i] = is_linear(node.left) && is_linear(node.right);
        break;
      case Operation::multiply:
        linear[i] =
            (is_linear(node.left) && is_free_of_s(node.right)) || (is_free_of_s(node.left) && is_linear(node.right));
        break;
      case Operation::divide:
        linear[i] = is_linear(node.left) && is_free_of_s(node.right);
        break;
      default:
        break;
    }
  }
  return linear;
}

}  // namespace

ParameterUse parameter_use(const Expression& expression) {
  const std::vector<Node>& nodes = expression.nodes;
  const std::vector<bool> linear = linear_in_s(nodes);
  std::vector<Surroundings> around(nodes.size());
  ParameterUse use{std::vector<ParameterRole>(expression.parameter_names.size(), ParameterRole::coefficient),
                   std::vector<bool>(expression.parameter_names.size(), false),
                   std::vector<bool>(expression.parameter_names.size(), false)};

  // Users stand behind their operands, so going backwards each node is complete before its operands are marked.
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const Node& node = nodes[i];
    const Surroundings here = around[i];
    if (node.operation == Operation::parameter) {
      const auto parameter = static_cast<std::size_t>(node.parameter);
      use.in_sum[parameter] = here.in_sum;
      if (here.in_exponent) {
        use.roles[parameter] = ParameterRole::order;
      } else if (here.factor_of_delay) {
        use.roles[parameter] = ParameterRole::delay;
      } else {
        use.keeps_sign[parameter] = here.keeps_sign;
      }
      continue;
    }
    const auto mark = [&](int index, bool is_right) {
      if (index < 0) return;
      const Node& operand = nodes[static_cast<std::size_t>(index)];
      Surroundings& marks = around[static_cast<std::size_t>(index)];
      const bool is_exponent = is_right && is_power(node.operation);
      const bool is_divisor = is_right && node.operation == Operation::divide;
      const bool carries_factors = is_sum(node.operation) || node.operation == Operation::negate ||
                                   node.operation == Operation::multiply ||
                                   (node.operation == Operation::divide && !is_divisor);
      const bool is_inner = !is_sum(node.operation) && node.operation != Operation::negate &&
                            node.operation != Operation::multiply && node.operation != Operation::divide;
      marks.in_divisor = marks.in_divisor || here.in_divisor || is_divisor;
      marks.keeps_sign = marks.keeps_sign || here.keeps_sign || is_inner || (here.in_divisor && is_sum(node.operation));
      // A sum within an exponent does not put the power into a sum.
      marks.in_sum = marks.in_sum || here.in_sum || (is_sum(node.operation) && !here.in_exponent);
      marks.in_exponent = marks.in_exponent || here.in_exponent || is_exponent;
      if (node.operation == Operation::exp && operand.has_s) marks.linear_in_exp = true;
      if (here.linear_in_exp && carries_factors && operand.has_s) marks.linear_in_exp = true;
      const bool multiplies_s = here.linear_in_exp && linear[i] && !operand.has_s && carries_factors;
      if (multiplies_s || (here.factor_of_delay && carries_factors)) marks.factor_of_delay = true;
    };
    mark(node.left, false);
    mark(node.right, true);
  }
  return use;
}

std::vector<bool> orders_of_plain_powers(const Expression& expression) {
  const std::vector<Node>& nodes = expression.nodes;
  // What a node is to the whole; one that occurs several times collects all.
  struct Place {
    bool part_of_sum = false, factor_of_term = false, elsewhere = false;
  };
  std::vector<Place> places(nodes.size());
  std::vector<bool> as_plain_order(expression.parameter_names.size(), false), otherwise = as_plain_order;
  places.back().part_of_sum = true;
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const Node& node = nodes[i];
    const Place here = places[i];
    const auto place_of = [&](int index) -> Place& { return places[static_cast<std::size_t>(index)]; };
    const bool in_term = here.part_of_sum || here.factor_of_term;
    for (const int index : {node.left, node.right}) {
      if (index < 0) continue;
      Place& operand = place_of(index);
      const bool is_sum_of_terms = here.part_of_sum && (is_sum(node.operation) || node.operation == Operation::negate);
      const bool is_factor = in_term && node.operation == Operation::multiply;
      if (is_sum_of_terms) operand.part_of_sum = true;
      if (is_factor) operand.factor_of_term = true;
      if ((!is_sum_of_terms && !is_factor) || here.elsewhere) operand.elsewhere = true;
    }
    if (node.operation != Operation::power_of_s) continue;
    const Node& exponent = nodes[static_cast<std::size_t>(node.right)];
    if (exponent.operation != Operation::parameter) continue;
    const auto parameter = static_cast<std::size_t>(exponent.parameter);
    (in_term && !here.elsewhere ? as_plain_order : otherwise)[parameter] = true;
  }
  // A parameter of an order that is used as anything else, too, keeps to what that allows.
  std::vector<std::size_t> uses(expression.parameter_names.size(), 0), orders = uses;
  for (const Node& node : nodes) {
    for (const int index : {node.left, node.right}) {
      if (index < 0 || nodes[static_cast<std::size_t>(index)].operation != Operation::parameter) continue;
      const auto parameter = static_cast<std::size_t>(nodes[static_cast<std::size_t>(index)].parameter);
      ++uses[parameter];
      if (node.operation == Operation::power_of_s && index == node.right) ++orders[parameter];
    }
  }
  for (std::size_t p = 0; p < uses.size(); ++p) {
    as_plain_order[p] = as_plain_order[p] && !otherwise[p] && uses[p] == orders[p];
  }
  return as_plain_order;
}

}  // namespace frac::detail
