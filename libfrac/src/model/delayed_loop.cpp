// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/delayed_loop.hpp"

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "formula/expression.hpp"
#include "formula/reduction.hpp"
#include "frac/model/algebra.hpp"

namespace frac {
namespace {

using detail::Operation;
using Plain = FractionalTransferFunction;

// Thrown within this file: the formula is no such loop.
struct NoLoop {};

// A ratio of sums of powers, over 1 + loop where that is not empty.
struct Form {
  Plain forward;
  std::optional<Plain> loop = {};
};

class Reader {
 public:
  Reader(const detail::Expression& expression, std::span<const double> parameters)
      : expression_(expression), parameters_(parameters) {}

  [[nodiscard]] Form form(int index) const {
    if (std::optional<Plain> plain = plain_of(index)) return {*std::move(plain)};
    const detail::Node& node = node_at(index);
    switch (node.operation) {
      case Operation::negate: {
        Form result = form(node.left);
        return {-result.forward, std::move(result.loop)};
      }
      case Operation::multiply:
        return multiplied(form(node.left), form(node.right));
      case Operation::divide:
        return divided(form(node.left), node.right);
      default:
        throw NoLoop{};
    }
  }

 private:
  [[nodiscard]] const detail::Node& node_at(int index) const {
    return expression_.nodes[static_cast<std::size_t>(index)];
  }

  // A node's operands stand before it, so that the nodes up to it are an expression; those it does not use are made
  // numbers, so that they are reduced to nothing.
  [[nodiscard]] std::optional<Plain> plain_of(int index) const {
    detail::Expression part = expression_;
    part.nodes.resize(static_cast<std::size_t>(index) + 1);
    std::vector<bool> is_used(part.nodes.size(), false);
    is_used.back() = true;
    for (std::size_t i = part.nodes.size(); i-- > 0;) {
      detail::Node& node = part.nodes[i];
      if (!is_used[i]) {
        node = {Operation::number, false, false, -1, -1, 0, -1, node.begin, node.end};
        continue;
      }
      for (const int operand : {node.left, node.right})
        if (operand >= 0) is_used[static_cast<std::size_t>(operand)] = true;
    }
    try {
      const detail::RatioOfPowerSums ratio = detail::reduce(part, parameters_);
      return Plain(detail::plain_terms(ratio.numerator), detail::plain_terms(ratio.denominator), ratio.delay);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
  }

  [[nodiscard]] static Form multiplied(const Form& a, Form b) {
    if (a.loop && b.loop) throw NoLoop{};
    return {a.forward * b.forward, a.loop ? a.loop : std::move(b.loop)};
  }

  [[nodiscard]] Form divided(Form dividend, int divisor) const {
    if (const std::optional<Plain> plain = plain_of(divisor)) {
      return {dividend.forward / *plain, std::move(dividend.loop)};
    }
    const detail::Node& node = node_at(divisor);
    if (node.operation == Operation::multiply) return divided(divided(std::move(dividend), node.left), node.right);
    if (dividend.loop) throw NoLoop{};
    std::vector<Plain> sum;
    add_terms(divisor, 1, sum);
    if (sum.size() != 2) throw NoLoop{};
    if (sum[1].delay() < sum[0].delay()) std::swap(sum[0], sum[1]);
    return {dividend.forward / sum[0], sum[1] / sum[0]};
  }

  // The terms of a sum, those of equal dead time added up.
  void add_terms(int index, double factor, std::vector<Plain>& sum) const {
    if (const std::optional<Plain> plain = plain_of(index)) {
      for (Plain& each : sum) {
        if (each.delay() != plain->delay()) continue;
        each = each + factor * *plain;
        return;
      }
      sum.push_back(factor * *plain);
      return;
    }
    const detail::Node& node = node_at(index);
    if (node.operation == Operation::negate) {
      add_terms(node.left, -factor, sum);
    } else if (node.operation == Operation::add || node.operation == Operation::subtract) {
      add_terms(node.left, factor, sum);
      add_terms(node.right, node.operation == Operation::add ? factor : -factor, sum);
    } else {
      throw NoLoop{};
    }
  }

  const detail::Expression& expression_;
  std::span<const double> parameters_;
};

}  // namespace

std::optional<DelayedLoop> delayed_loop(const Structure& structure, std::span<const double> parameters) {
  if (parameters.size() != structure.parameter_names().size()) {
    throw std::invalid_argument("delayed_loop: " + std::to_string(parameters.size()) + " parameter values where " +
                                std::to_string(structure.parameter_names().size()) + " are needed");
  }
  const detail::Expression& expression = structure.expression();
  try {
    Form form = Reader(expression, parameters).form(static_cast<int>(expression.nodes.size()) - 1);
    if (!form.loop) return std::nullopt;
    return DelayedLoop{std::move(form.forward), *std::move(form.loop)};
  } catch (const NoLoop&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {
    // A quotient that would look into the future, or a sum that vanishes.
    return std::nullopt;
  }
}

}  // namespace frac
