// SPDX-License-Identifier: BSD-3-Clause
#include "factored_ratio.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "power_sum.hpp"

namespace frac::detail {
namespace {

using Factors = std::vector<PowerFactor>;
constexpr int most_roots_of_one_factor = 1000;

/// Not a ratio of sums of powers, or too large.
struct NoRatio {};

/// coefficient s^order numerator/denominator.
struct Form {
  double coefficient = 1;
  double order = 0;
  Factors numerator = {};
  Factors denominator = {};

  [[nodiscard]] bool is_term() const { return numerator.empty() && denominator.empty(); }
};

Form constant(double value) {
  if (!std::isfinite(value)) throw NoRatio{};
  return {value, 0};
}

// A sum as a factor that starts at the order 0.
Form form_of(std::vector<PowerTerm> sum) {
  if (sum.empty()) return constant(0);
  const double lowest = sum.back().order;
  if (sum.size() == 1) return {sum[0].coefficient, lowest};
  sum = scaled(std::move(sum), 1, -lowest);
  return {1, lowest, {{std::move(sum), 1}}};
}

Form multiplied(Form a, const Form& b) {
  a.coefficient *= b.coefficient;
  a.order += b.order;
  if (a.coefficient == 0) return constant(0);
  for (const PowerFactor& each : b.numerator) multiply(a.numerator, each);
  for (const PowerFactor& each : b.denominator) multiply(a.denominator, each);
  return a;
}

Form inverse(Form form) {
  if (form.coefficient == 0) throw NoRatio{};
  std::swap(form.numerator, form.denominator);
  form.coefficient = 1 / form.coefficient;
  form.order = -form.order;
  return form;
}

Form raised(Form form, double exponent) {
  if (exponent < 0) return raised(inverse(std::move(form)), -exponent);
  if (form.is_term()) {
    const bool whole = exponent == std::nearbyint(exponent);
    // (c s^p)^q = c^q s^(p q) for principal values only while the angle p pi/2 stays below pi.
    if (!whole && !(form.coefficient > 0 && std::abs(form.order) < 2)) throw NoRatio{};
    return {constant(std::pow(form.coefficient, exponent)).coefficient, form.order * exponent};
  }
  if (exponent != std::nearbyint(exponent) || exponent > most_roots_of_one_factor) throw NoRatio{};
  if (exponent == 0) return constant(1);
  form.coefficient = constant(std::pow(form.coefficient, exponent)).coefficient;
  form.order *= exponent;
  for (Factors* factors : {&form.numerator, &form.denominator}) {
    for (PowerFactor& each : *factors) {
      if (each.power * exponent > most_roots_of_one_factor) throw NoRatio{};
      each.power *= static_cast<int>(exponent);
    }
  }
  return form;
}

// The factors of `all` that `own` lacks.
Factors missing(const Factors& all, const Factors& own) {
  Factors result = all;
  for (const PowerFactor& each : own) {
    const auto same =
        std::find_if(result.begin(), result.end(), [&](const PowerFactor& other) { return other.sum == each.sum; });
    same->power -= each.power;
  }
  std::erase_if(result, [](const PowerFactor& each) { return each.power == 0; });
  return result;
}

Factors least_common(Factors a, const Factors& b) {
  for (const PowerFactor& each : b) {
    const auto same = std::find_if(a.begin(), a.end(), [&](const PowerFactor& other) { return other.sum == each.sum; });
    if (same == a.end()) {
      a.push_back(each);
    } else {
      same->power = std::max(same->power, each.power);
    }
  }
  return a;
}

Form sum(const Form& a, const Form& b, double sign) {
  if (b.coefficient == 0) return a;
  if (a.coefficient == 0) return multiplied(b, constant(sign));
  const Factors denominator = least_common(a.denominator, b.denominator);
  const auto part = [&](const Form& form, double factor) {
    Factors top = form.numerator;
    for (const PowerFactor& each : missing(denominator, form.denominator)) multiply(top, each);
    return scaled(expanded(top), factor * form.coefficient, form.order);
  };
  Form result = form_of(merged(part(a, 1), part(b, sign)));
  if (result.coefficient != 0) result.denominator = denominator;
  return result;
}

// exp(constant - delay s) without its dead time.
Form exponential(const Form& argument) {
  if (argument.coefficient == 0) return constant(1);
  if (!argument.denominator.empty()) throw NoRatio{};
  double value = 0;
  for (const PowerTerm& term : scaled(expanded(argument.numerator), argument.coefficient, argument.order)) {
    if (term.order == 0) value = term.coefficient;
  }
  return constant(std::exp(value));
}

Form apply(const Node& node, const std::vector<Form>& done, const std::vector<double>& real) {
  const auto left = [&]() -> const Form& { return done[static_cast<std::size_t>(node.left)]; };
  const auto right = [&]() -> const Form& { return done[static_cast<std::size_t>(node.right)]; };
  const auto real_right = [&] { return real[static_cast<std::size_t>(node.right)]; };
  switch (node.operation) {
    case Operation::laplace:
    case Operation::exact_laplace:
      return {1, 1};
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
      return raised(left(), real_right());
    case Operation::power_of_s:
      return {constant(std::pow(real[static_cast<std::size_t>(node.left)], real_right())).coefficient, real_right()};
    case Operation::sqrt:
      return raised(left(), 0.5);
    case Operation::exp:
      return exponential(left());
    default:
      throw NoRatio{};
  }
}

int roots_given(const Factors& factors) {
  int count = 0;
  for (const PowerFactor& each : factors) count += each.power;
  return count;
}

}  // namespace

std::optional<FactoredRatio> factored_ratio(const Expression& expression, std::span<const double> parameters) {
  try {
    std::vector<double> real;
    evaluate_real_nodes(expression, parameters.data(), real);
    std::vector<Form> done;
    done.reserve(expression.nodes.size());
    for (std::size_t i = 0; i < expression.nodes.size(); ++i) {
      const Node& node = expression.nodes[i];
      done.push_back(node.has_s ? apply(node, done, real) : constant(real[i]));
    }
    Form& whole = done.back();
    if (roots_given(whole.numerator) < 2 && roots_given(whole.denominator) < 2) return std::nullopt;
    // Powers of s stand on the side where their order is positive.
    const PowerTerm top{whole.coefficient, std::max(whole.order, 0.0)};
    const PowerTerm bottom{1, std::max(-whole.order, 0.0)};
    if (top != PowerTerm{1, 0} || whole.numerator.empty()) {
      whole.numerator.insert(whole.numerator.begin(), {{top}, 1});
    }
    if (bottom != PowerTerm{1, 0} || whole.denominator.empty()) {
      whole.denominator.insert(whole.denominator.begin(), {{bottom}, 1});
    }
    return FactoredRatio{std::move(whole.numerator), std::move(whole.denominator)};
  } catch (const NoRatio&) {
    return std::nullopt;
  } catch (const std::invalid_argument&) {  // an expansion has too many terms
    return std::nullopt;
  }
}

}  // namespace frac::detail
