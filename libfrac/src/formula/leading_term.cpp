// SPDX-License-Identifier: BSD-3-Clause
#include "leading_term.hpp"

#include <cmath>
#include <limits>
#include <vector>

namespace frac::detail {
namespace {

using Term = std::optional<PowerTerm>;
constexpr double infinity = std::numeric_limits<double>::infinity();

class LeadingTerms {
 public:
  LeadingTerms(const Expression& expression, std::span<const double> parameters, Limit limit)
      : expression_(expression), sign_(limit == Limit::infinity ? 1 : -1) {
    evaluate_real_nodes(expression, parameters.data(), real_);
    for (std::size_t i = 0; i < expression.nodes.size(); ++i) {
      const Node& node = expression.nodes[i];
      term_.push_back(checked(node.has_s ? of(node) : Term({real_[i], 0})));
    }
  }

  [[nodiscard]] const Term& whole() const { return term_.back(); }

 private:
  static Term checked(const Term& term) {
    return term && std::isfinite(term->coefficient) && !std::isnan(term->order) ? term : std::nullopt;
  }
  /// Of the size of a term: above 0 where it grows towards the limit.
  [[nodiscard]] double growth(const PowerTerm& term) const { return sign_ * term.order; }
  [[nodiscard]] double exponent(const Node& node) const {
    return expression_.nodes[static_cast<std::size_t>(node.right)].has_s ? std::nan("")
                                                                         : real_[static_cast<std::size_t>(node.right)];
  }

  [[nodiscard]] Term sum(const PowerTerm& a, const PowerTerm& b) const {
    if (a.coefficient == 0 || b.coefficient == 0) return a.coefficient == 0 ? b : a;
    // Equal orders may differ by the rounding of what they were computed from.
    constexpr double rounding = 1e-12;
    if (a.order != b.order && !(std::abs(a.order - b.order) <= rounding)) return growth(a) > growth(b) ? a : b;
    const double coefficient = a.coefficient + b.coefficient;
    if (!(std::abs(coefficient) > rounding * std::abs(a.coefficient))) return std::nullopt;
    return PowerTerm{coefficient, a.order};
  }

  static Term product(const PowerTerm& a, const PowerTerm& b) {
    return PowerTerm{a.coefficient * b.coefficient, a.order + b.order};
  }

  static Term power(const PowerTerm& base, double exponent) {
    return PowerTerm{std::pow(base.coefficient, exponent), exponent == 0 ? 0 : base.order * exponent};
  }

  /// A function of z that is `at_zero`, a term, where z vanishes and `at_large` where z grows without bound.
  template <class Function>
  [[nodiscard]] Term of_function(const PowerTerm& z, const Function& function, const Term& at_zero,
                                 const Term& at_large) const {
    if (growth(z) == 0) return PowerTerm{function(z.coefficient), 0};
    return growth(z) < 0 ? at_zero : at_large;
  }

  [[nodiscard]] Term of(const Node& node) const {
    const PowerTerm one{1, 0}, exploding{1, sign_ * infinity}, vanishing{1, -sign_ * infinity};
    if (node.operation == Operation::laplace || node.operation == Operation::exact_laplace) return PowerTerm{1, 1};
    const Term& left = term_[static_cast<std::size_t>(node.left)];
    if (!left) return std::nullopt;
    const Term right = node.right < 0 ? Term(one) : term_[static_cast<std::size_t>(node.right)];
    if (!right) return std::nullopt;
    const double sign = left->coefficient < 0 ? -1 : 1;
    switch (node.operation) {
      case Operation::add:
        return sum(*left, *right);
      case Operation::subtract:
        return sum(*left, {-right->coefficient, right->order});
      case Operation::multiply:
        return product(*left, *right);
      case Operation::divide:
        return product(*left, *power(*right, -1));
      case Operation::negate:
        return PowerTerm{-left->coefficient, left->order};
      case Operation::power:
        return power(*left, exponent(node));
      case Operation::power_of_s:
        return power({left->coefficient, 1}, exponent(node));
      case Operation::sqrt:
        return power(*left, 0.5);
      case Operation::tanh:
        return of_function(
            *left, [](double z) { return std::tanh(z); }, left, PowerTerm{sign, 0});
      case Operation::coth:
        return of_function(
            *left, [](double z) { return 1 / std::tanh(z); }, power(*left, -1), PowerTerm{sign, 0});
      case Operation::sinh:
        return of_function(
            *left, [](double z) { return std::sinh(z); }, left, PowerTerm{sign, exploding.order});
      case Operation::cosh:
        return of_function(
            *left, [](double z) { return std::cosh(z); }, one, exploding);
      case Operation::sech:
        return of_function(
            *left, [](double z) { return 1 / std::cosh(z); }, one, vanishing);
      case Operation::exp:
        return of_function(
            *left, [](double z) { return std::exp(z); }, one, sign > 0 ? exploding : vanishing);
      case Operation::log:
        return of_function(
            *left, [](double z) { return std::log(z); }, std::nullopt, std::nullopt);
      case Operation::laplace:
      case Operation::exact_laplace:
      case Operation::number:
      case Operation::parameter:
        break;
    }
    return std::nullopt;
  }

  const Expression& expression_;
  double sign_;
  std::vector<double> real_;
  std::vector<Term> term_;
};

}  // namespace

std::optional<PowerTerm> leading_term(const Expression& expression, std::span<const double> parameters, Limit limit) {
  return LeadingTerms(expression, parameters, limit).whole();
}

}  // namespace frac::detail
