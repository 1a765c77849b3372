// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/fractional_transfer_function.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/number_text.hpp"
#include "formula/factored_ratio.hpp"
#include "formula/power_sum.hpp"
#include "formula/reduction.hpp"
#include "realisation/prepared_power.hpp"
#include "realisation/realisation_checks.hpp"

namespace frac {
namespace {

std::vector<PowerTerm> checked(std::vector<PowerTerm> terms, const std::string& name) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!std::isfinite(terms[i].coefficient) || !std::isfinite(terms[i].order)) {
      throw std::invalid_argument("transfer function: " + name + "[" + std::to_string(i) +
                                  "] = " + detail::number_text(terms[i].coefficient) + " s^" +
                                  detail::number_text(terms[i].order) + " is not finite");
    }
  }
  terms = detail::collected(std::move(terms));
  if (terms.empty()) throw std::invalid_argument("transfer function: the " + name + " is zero");
  return terms;
}

std::string term_text(double coefficient, double order) {
  const std::string power = order == 0 ? "" : (order == 1 ? std::string("s") : "s^" + detail::number_text(order));
  if (power.empty()) return detail::number_text(coefficient);
  return coefficient == 1 ? power : detail::number_text(coefficient) + " " + power;
}

std::string sum_text(const std::vector<PowerTerm>& terms) {
  std::string text;
  for (const PowerTerm& term : terms) {
    const bool minus = term.coefficient < 0;
    if (!text.empty()) text += ' ';
    if (minus || !text.empty()) text += minus ? '-' : '+';
    if (text.size() > 1) text += ' ';
    text += term_text(std::abs(term.coefficient), term.order);
  }
  return text;
}

std::string parenthesised(const std::string& text) {
  std::string result;
  result += '(';
  result += text;
  result += ')';
  return result;
}

bool is_one(const std::vector<PowerTerm>& terms) {
  return terms == std::vector<PowerTerm>{{1, 0}};
}

std::string factors_text(const std::vector<PowerFactor>& factors) {
  std::string text;
  for (const PowerFactor& factor : factors) {
    if (!text.empty()) text += ' ';
    text += factor.sum.size() == 1 ? sum_text(factor.sum) : parenthesised(sum_text(factor.sum));
    if (factor.power > 1) text += '^' + std::to_string(factor.power);
  }
  return text;
}

// coefficient s^order times powers of sums that start at the order 0, equal ones as one.
struct Ordered {
  PowerTerm term{1, 0};
  std::vector<PowerFactor> sums;
};
Ordered ordered(std::vector<PowerFactor> factors, const std::string& name) {
  Ordered result;
  for (PowerFactor& factor : factors) {
    if (factor.power < 1) {
      throw std::invalid_argument("transfer function: a factor of the " + name + " has the power " +
                                  std::to_string(factor.power) + "; allowed is 1 or more");
    }
    std::vector<PowerTerm> sum = checked(std::move(factor.sum), name);
    const double lowest = sum.back().order;
    result.term.order += factor.power * lowest;
    if (sum.size() == 1) {
      result.term.coefficient *= std::pow(sum[0].coefficient, factor.power);
    } else {
      detail::multiply(result.sums, {detail::scaled(std::move(sum), 1, -lowest), factor.power});
    }
  }
  return result;
}

// The term first, unless it is 1.
std::vector<PowerFactor> factors_of(Ordered product) {
  if (product.term != PowerTerm{1, 0} || product.sums.empty()) {
    product.sums.insert(product.sums.begin(), {{product.term}, 1});
  }
  return std::move(product.sums);
}

bool is_single_sum(const std::vector<PowerFactor>& factors) {
  int sums = 0;
  for (const PowerFactor& factor : factors) sums += factor.sum.size() > 1 ? factor.power : 0;
  return sums < 2;
}

// A product of sums of powers with the powers prepared for evaluation.
class PreparedProduct {
 public:
  PreparedProduct(const detail::PowerProduct& product, const Realisation& realisation) {
    product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
      factors_.push_back({terms, std::vector<detail::PreparedPower>(terms.size()), power});
      for (std::size_t i = 0; i < terms.size(); ++i) factors_.back().powers[i].prepare(realisation, terms[i].order);
    });
  }
  [[nodiscard]] std::complex<double> operator()(double omega) const {
    std::complex<double> product = factor_value(factors_[0], omega);
    for (std::size_t k = 1; k < factors_.size(); ++k) product *= factor_value(factors_[k], omega);
    return product;
  }

 private:
  struct Factor {
    std::vector<PowerTerm> terms;
    std::vector<detail::PreparedPower> powers;
    int power;
  };

  static std::complex<double> factor_value(const Factor& factor, double omega) {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < factor.terms.size(); ++i) {
      sum += factor.terms[i].coefficient * factor.powers[i].value(omega);
    }
    std::complex<double> value = sum;
    for (int i = 1; i < factor.power; ++i) value *= sum;
    return value;
  }

  std::vector<Factor> factors_;
};

}  // namespace

FractionalTransferFunction::FractionalTransferFunction(std::vector<PowerTerm> numerator,
                                                       std::vector<PowerTerm> denominator, double delay)
    : numerator_(checked(std::move(numerator), "numerator")),
      denominator_(checked(std::move(denominator), "denominator")),
      delay_(delay + 0.0) {
  if (!(std::isfinite(delay) && delay >= 0)) {
    throw std::invalid_argument("transfer function: delay = " + detail::number_text(delay) +
                                " s; allowed is 0 or more, finite");
  }
  if (denominator_.size() == 1) {
    const double divisor = denominator_[0].coefficient;
    for (PowerTerm& term : numerator_) term.coefficient /= divisor;
    denominator_[0].coefficient = 1;
    numerator_ = checked(std::move(numerator_), "numerator");
  }
}

FractionalTransferFunction FractionalTransferFunction::from_factors(std::vector<PowerFactor> numerator,
                                                                    std::vector<PowerFactor> denominator,
                                                                    double delay) {
  Ordered above = ordered(std::move(numerator), "numerator");
  Ordered below = ordered(std::move(denominator), "denominator");
  above.term.coefficient /= below.term.coefficient;
  below.term.coefficient = 1;
  const double common = std::min(above.term.order, below.term.order);
  if (common > 0) {
    above.term.order -= common;
    below.term.order -= common;
  }
  std::vector<PowerFactor> top = factors_of(std::move(above));
  std::vector<PowerFactor> bottom = factors_of(std::move(below));
  FractionalTransferFunction result(detail::expanded(top), detail::expanded(bottom), delay);
  if (is_single_sum(top) && is_single_sum(bottom)) return result;
  result.numerator_factors_ = std::move(top);
  result.denominator_factors_ = std::move(bottom);
  return result;
}

FractionalTransferFunction FractionalTransferFunction::parse(std::string_view formula) {
  const Structure structure(formula);
  if (!structure.parameter_names().empty()) {
    throw std::invalid_argument("transfer function: the parameter '" + structure.parameter_names()[0] + "' of \"" +
                                std::string(formula) + "\" has no value");
  }
  return to_transfer_function(structure, {});
}

std::string FractionalTransferFunction::formula() const {
  const bool factored = !numerator_factors_.empty();
  const std::string top = factored ? factors_text(numerator_factors_) : sum_text(numerator_);
  const std::string bottom = factored ? factors_text(denominator_factors_) : sum_text(denominator_);
  std::string text;
  if (delay_ > 0) {
    text = "exp(-" + detail::number_text(delay_) + " s)";
    if (factored && !is_one(numerator_)) {
      text += (numerator_factors_.front().sum.size() == 1 ? " * " : " ") + top;
    } else if (!is_one(numerator_)) {
      text += ' ' + parenthesised(top);
    }
  } else {
    text = top;
    if (!factored && numerator_.size() > 1 && !is_one(denominator_)) text = parenthesised(text);
  }
  if (is_one(denominator_)) return text;
  const bool needs_parentheses =
      factored ? denominator_factors_.size() > 1 || denominator_factors_.front().power > 1 : denominator_.size() > 1;
  return text + '/' + (needs_parentheses ? parenthesised(bottom) : bottom);
}

std::complex<double> FractionalTransferFunction::response(double omega, const Realisation& realisation) const {
  validate(realisation);
  detail::check_omega(realisation, omega, "response of a transfer function");
  const std::complex<double> ratio = PreparedProduct({numerator_factors_, numerator_}, realisation)(omega) /
                                     PreparedProduct({denominator_factors_, denominator_}, realisation)(omega);
  return std::polar(1.0, -delay_ * omega) * ratio;
}

FrequencyResponseData FractionalTransferFunction::response(const std::vector<double>& omega,
                                                           const Realisation& realisation) const {
  validate(realisation);
  const PreparedProduct numerator({numerator_factors_, numerator_}, realisation);
  const PreparedProduct denominator({denominator_factors_, denominator_}, realisation);
  std::vector<std::complex<double>> value;
  value.reserve(omega.size());
  for (const double each : omega) {
    detail::check_omega(realisation, each, "response of a transfer function");
    value.push_back(std::polar(1.0, -delay_ * each) * (numerator(each) / denominator(each)));
  }
  return {omega, std::move(value)};
}

FractionalTransferFunction to_transfer_function(const Structure& structure, std::span<const double> parameters) {
  const std::vector<std::string>& names = structure.parameter_names();
  if (parameters.size() != names.size()) {
    throw std::invalid_argument("to_transfer_function: " + std::to_string(parameters.size()) +
                                " parameter values where " + std::to_string(names.size()) + " are needed");
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (!std::isfinite(parameters[i])) {
      throw std::invalid_argument("to_transfer_function: " + names[i] + " = " + detail::number_text(parameters[i]) +
                                  " is not finite");
    }
  }
  const detail::RatioOfPowerSums ratio = detail::reduce(structure.expression(), parameters);
  if (auto factored = detail::factored_ratio(structure.expression(), parameters)) {
    return FractionalTransferFunction::from_factors(std::move(factored->numerator), std::move(factored->denominator),
                                                    ratio.delay);
  }
  return {detail::plain_terms(ratio.numerator), detail::plain_terms(ratio.denominator), ratio.delay};
}

}  // namespace frac
