// SPDX-License-Identifier: BSD-3-Clause
#include "coefficient_form.hpp"

#include <algorithm>
#include <cmath>

#include "formula/expression.hpp"
#include "formula/power_algebra.hpp"

namespace frac::detail {

namespace {

using Sum = std::vector<Monomial>;

constexpr std::size_t most_monomials = 200;

/// Not a ratio of sums of powers.
struct NoRatio {};

struct Ratio {
  Sum numerator, denominator;
  double delay = 0;
};

Monomial product(const Monomial& a, const Monomial& b) {
  Monomial result{a.factor * b.factor, a.powers, a.order + b.order};
  for (std::size_t i = 0; i < b.powers.size(); ++i) result.powers[i] += b.powers[i];
  return result;
}

Monomial power(Monomial base, double exponent) {
  base.factor = std::pow(base.factor, exponent);
  if (!std::isfinite(base.factor)) throw NoRatio{};
  for (double& each : base.powers) each *= exponent;
  base.order *= exponent;
  return base;
}

bool have_same_order(double a, double b) {
  return std::abs(a - b) <= order_tolerance * std::max({1.0, std::abs(a), std::abs(b)});
}

// Adds a monomial to the one that is alike, if there is one.
void add_to(Sum& sum, const Monomial& monomial) {
  const auto same = std::find_if(sum.begin(), sum.end(), [&](const Monomial& each) {
    return each.powers == monomial.powers && have_same_order(each.order, monomial.order);
  });
  if (same == sum.end()) {
    sum.push_back(monomial);
  } else {
    same->factor = sum_or_nothing(same->factor, monomial.factor);
  }
}

Sum product(const Sum& a, const Sum& b) {
  Sum result;
  for (const Monomial& left : a) {
    for (const Monomial& right : b) add_to(result, product(left, right));
  }
  if (result.size() > most_monomials) throw NoRatio{};
  return result;
}

bool is_one(const Sum& sum) {
  return sum.size() == 1 && sum[0].factor == 1 && sum[0].order == 0 &&
         std::all_of(sum[0].powers.begin(), sum[0].powers.end(), [](double each) { return each == 0; });
}

/// Expands an expression node by node.
class Expansion {
 public:
  Expansion(const Structure& structure, std::span<const double> parameters)
      : structure_(structure), parameters_(parameters) {}

  Ratio run() {
    const std::vector<Node>& nodes = structure_.expression().nodes;
    std::vector<Ratio> done;
    done.reserve(nodes.size());
    for (const Node& node : nodes) done.push_back(expand(node, done));
    return done.back();
  }

 private:
  [[nodiscard]] Monomial number(double factor) const {
    return {factor, std::vector<double>(parameters_.size(), 0.0), 0};
  }
  [[nodiscard]] Ratio constant(double factor) const { return {{number(factor)}, {number(1)}, 0}; }

  Ratio expand(const Node& node, const std::vector<Ratio>& done) const {
    const auto left = [&]() -> const Ratio& { return done[static_cast<std::size_t>(node.left)]; };
    const auto right = [&]() -> const Ratio& { return done[static_cast<std::size_t>(node.right)]; };
    switch (node.operation) {
      case Operation::number:
        return constant(node.number);
      case Operation::parameter: {
        const auto index = static_cast<std::size_t>(node.parameter);
        if (structure_.parameter_roles()[index] != ParameterRole::coefficient) return constant(parameters_[index]);
        Ratio result = constant(1);
        result.numerator[0].powers[index] = 1;
        return result;
      }
      case Operation::laplace:
      case Operation::exact_laplace: {
        Ratio result = constant(1);
        result.numerator[0].order = 1;
        return result;
      }
      case Operation::add:
        return sum(left(), right(), 1);
      case Operation::subtract:
        return sum(left(), right(), -1);
      case Operation::multiply:
        return multiplied(left(), right());
      case Operation::divide:
        return multiplied(left(), inverse(right()));
      case Operation::negate:
        return multiplied(left(), constant(-1));
      case Operation::power:
        return raised(left(), value_of(right()));
      case Operation::power_of_s:
        return raised(multiplied(left(), of_s()), value_of(right()));
      case Operation::sqrt:
        return raised(left(), 0.5);
      case Operation::exp:
        return delay(left());
      default:
        throw NoRatio{};
    }
  }

  [[nodiscard]] Ratio of_s() const {
    Ratio result = constant(1);
    result.numerator[0].order = 1;
    return result;
  }

  static double value_of(const Ratio& ratio) {
    if (ratio.numerator.size() != 1 || !is_one(ratio.denominator)) throw NoRatio{};
    Monomial only = ratio.numerator[0];
    const double value = only.factor;
    only.factor = 1;
    if (!is_one({only})) throw NoRatio{};
    return value;
  }

  static Ratio sum(const Ratio& a, const Ratio& b, double sign) {
    if (a.delay != b.delay) throw NoRatio{};
    Ratio result{product(a.numerator, b.denominator), product(a.denominator, b.denominator), a.delay};
    for (Monomial& each : product(b.numerator, a.denominator)) {
      each.factor *= sign;
      add_to(result.numerator, each);
    }
    return result;
  }

  static Ratio multiplied(const Ratio& a, const Ratio& b) {
    return {product(a.numerator, b.numerator), product(a.denominator, b.denominator), a.delay + b.delay};
  }

  static Ratio inverse(const Ratio& ratio) {
    if (ratio.numerator.size() == 1) {
      // 1/monomial as a monomial, so that a constant of the denominator stays what it is.
      Ratio result{product(ratio.denominator, {power(ratio.numerator[0], -1)}), {ratio.numerator[0]}, -ratio.delay};
      result.denominator[0] = product(ratio.numerator[0], power(ratio.numerator[0], -1));
      return result;
    }
    return {ratio.denominator, ratio.numerator, -ratio.delay};
  }

  Ratio raised(const Ratio& base, double exponent) const {
    if (exponent == std::nearbyint(exponent) && std::abs(exponent) <= largest_expanded_power) {
      const Ratio factor = exponent < 0 ? inverse(base) : base;
      Ratio result = constant(1);
      for (int i = 0; i < std::abs(static_cast<int>(exponent)); ++i) result = multiplied(result, factor);
      return result;
    }
    if (base.numerator.size() != 1 || base.denominator.size() != 1 || base.delay != 0) throw NoRatio{};
    const Monomial whole = product(base.numerator[0], power(base.denominator[0], -1));
    // (s^p)^q = s^(p q) for principal values only while the angle p pi/2 stays below pi.
    if (!(whole.factor > 0) || !(std::abs(whole.order) < 2)) throw NoRatio{};
    return {{power(whole, exponent)}, {number(1)}, 0};
  }

  /// exp(-L s) with a known L.
  Ratio delay(const Ratio& argument) const {
    if (argument.numerator.size() != 1 || !is_one(argument.denominator)) throw NoRatio{};
    Monomial only = argument.numerator[0];
    if (only.order != 1) throw NoRatio{};
    only.order = 0;
    Ratio result = constant(1);
    result.delay = -value_of({{only}, {number(1)}, 0});
    return result;
  }

  const Structure& structure_;
  std::span<const double> parameters_;
};

std::vector<CoefficientTerm> by_order(const Sum& sum, double shift) {
  std::vector<CoefficientTerm> terms;
  for (const Monomial& monomial : sum) {
    const double order = monomial.order - shift;
    auto place = std::find_if(terms.begin(), terms.end(),
                              [&](const CoefficientTerm& term) { return have_same_order(term.order, order); });
    if (place == terms.end()) place = terms.insert(terms.end(), {order, {}});
    Monomial shifted = monomial;
    shifted.order = place->order;
    add_to(place->monomials, shifted);
  }
  for (CoefficientTerm& term : terms)
    std::erase_if(term.monomials, [](const Monomial& each) { return each.factor == 0; });
  std::erase_if(terms, [](const CoefficientTerm& term) { return term.monomials.empty(); });
  return terms;
}

double lowest_order(const Sum& sum) {
  double lowest = sum.front().order;
  for (const Monomial& each : sum) lowest = std::min(lowest, each.order);
  return lowest;
}

double monomial_value(const Monomial& monomial, std::span<const double> parameters) {
  double value = monomial.factor;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (monomial.powers[i] == 0) continue;
    value *= monomial.powers[i] == 1 ? parameters[i] : std::pow(parameters[i], monomial.powers[i]);
  }
  return value;
}

}  // namespace

bool CoefficientTerm::is_constant() const {
  return monomials.size() == 1 &&
         std::all_of(monomials[0].powers.begin(), monomials[0].powers.end(), [](double each) { return each == 0; });
}

double CoefficientTerm::value(std::span<const double> parameters) const {
  double sum = 0;
  for (const Monomial& each : monomials) sum += monomial_value(each, parameters);
  return sum;
}

double CoefficientTerm::by_log(std::span<const double> parameters, std::size_t parameter) const {
  double sum = 0;
  for (const Monomial& each : monomials) sum += each.powers[parameter] * monomial_value(each, parameters);
  return sum;
}

std::optional<CoefficientForm> coefficient_form(const Structure& structure, std::span<const double> parameters) {
  try {
    const Ratio ratio = Expansion(structure, parameters).run();
    const double shift = std::min(lowest_order(ratio.numerator), lowest_order(ratio.denominator));
    CoefficientForm form{by_order(ratio.numerator, shift), by_order(ratio.denominator, shift), ratio.delay};
    if (form.numerator.empty() || form.denominator.empty()) return std::nullopt;
    return form;
  } catch (const NoRatio&) {
    return std::nullopt;
  }
}

}  // namespace frac::detail
