// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/fractional_transfer_function.hpp"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/number_text.hpp"
#include "formula/power_sum.hpp"
#include "formula/reduction.hpp"
#include "realisation/prepared_power.hpp"
#include "realisation/realisation_checks.hpp"

namespace frac {
namespace {

std::vector<PowerTerm> checked(std::vector<PowerTerm> terms, const std::string& name) {
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (!std::isfinite(terms[i].coefficient) || !std::isfinite(terms[i].order)) {
      throw std::invalid_argument("FractionalTransferFunction: " + name + "[" + std::to_string(i) +
                                  "] = " + detail::number_text(terms[i].coefficient) + " s^" +
                                  detail::number_text(terms[i].order) + " is not finite");
    }
  }
  terms = detail::collected(std::move(terms));
  if (terms.empty()) throw std::invalid_argument("FractionalTransferFunction: the " + name + " is zero");
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

// A sum of powers with its powers prepared for evaluation.
class PreparedSum {
 public:
  PreparedSum(const std::vector<PowerTerm>& terms, const Realisation& realisation) : terms_(terms) {
    powers_.resize(terms.size());
    for (std::size_t i = 0; i < terms.size(); ++i) powers_[i].prepare(realisation, terms[i].order);
  }
  [[nodiscard]] std::complex<double> operator()(double omega) const {
    std::complex<double> sum = 0;
    for (std::size_t i = 0; i < terms_.size(); ++i) sum += terms_[i].coefficient * powers_[i].value(omega);
    return sum;
  }

 private:
  const std::vector<PowerTerm>& terms_;
  std::vector<detail::PreparedPower> powers_;
};

}  // namespace

FractionalTransferFunction::FractionalTransferFunction(std::vector<PowerTerm> numerator,
                                                       std::vector<PowerTerm> denominator, double delay)
    : numerator_(checked(std::move(numerator), "numerator")),
      denominator_(checked(std::move(denominator), "denominator")),
      delay_(delay + 0.0) {
  if (!(std::isfinite(delay) && delay >= 0)) {
    throw std::invalid_argument("FractionalTransferFunction: delay = " + detail::number_text(delay) +
                                " s; allowed is 0 or more, finite");
  }
  if (denominator_.size() == 1) {
    const double divisor = denominator_[0].coefficient;
    for (PowerTerm& term : numerator_) term.coefficient /= divisor;
    denominator_[0].coefficient = 1;
    numerator_ = checked(std::move(numerator_), "numerator");
  }
}

FractionalTransferFunction FractionalTransferFunction::parse(std::string_view formula) {
  const Structure structure(formula);
  if (!structure.parameter_names().empty()) {
    throw std::invalid_argument("FractionalTransferFunction: the parameter '" + structure.parameter_names()[0] +
                                "' of \"" + std::string(formula) + "\" has no value");
  }
  return to_transfer_function(structure, {});
}

std::string FractionalTransferFunction::formula() const {
  std::string text;
  if (delay_ > 0) {
    text = "exp(-" + detail::number_text(delay_) + " s)";
    if (!is_one(numerator_)) text += ' ' + parenthesised(sum_text(numerator_));
  } else {
    text = sum_text(numerator_);
    if (numerator_.size() > 1 && !is_one(denominator_)) text = parenthesised(text);
  }
  if (is_one(denominator_)) return text;
  const std::string denominator = sum_text(denominator_);
  return text + '/' + (denominator_.size() > 1 ? parenthesised(denominator) : denominator);
}

std::complex<double> FractionalTransferFunction::response(double omega, const Realisation& realisation) const {
  validate(realisation);
  detail::check_omega(realisation, omega, "FractionalTransferFunction::response");
  const std::complex<double> ratio =
      PreparedSum(numerator_, realisation)(omega) / PreparedSum(denominator_, realisation)(omega);
  return std::polar(1.0, -delay_ * omega) * ratio;
}

FrequencyResponseData FractionalTransferFunction::response(const std::vector<double>& omega,
                                                           const Realisation& realisation) const {
  validate(realisation);
  const PreparedSum numerator(numerator_, realisation);
  const PreparedSum denominator(denominator_, realisation);
  std::vector<std::complex<double>> value;
  value.reserve(omega.size());
  for (const double each : omega) {
    detail::check_omega(realisation, each, "FractionalTransferFunction::response");
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
  return {detail::plain_terms(ratio.numerator), detail::plain_terms(ratio.denominator), ratio.delay};
}

}  // namespace frac
